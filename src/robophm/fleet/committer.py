"""Payloads that came while others were written are committed together, so the disk is waited for once for all."""

from __future__ import annotations

import asyncio
from typing import NamedTuple

from starlette.concurrency import run_in_threadpool

from robophm.fleet.commit import Committed
from robophm.fleet.payload import Payload
from robophm.fleet.store import FleetStore

MOST_TOGETHER = 500
"""Payloads of one transaction, at most."""

MOST_WAITING = 64_000_000
"""Bytes of payloads, uncompressed, that wait before no more are taken in."""


class _Waiting(NamedTuple):
    payload: Payload
    done: asyncio.Future[Committed]


class Committer:
    """Commits payloads in the order in which they come; one task ``run`` does it."""

    def __init__(self, store: FleetStore) -> None:
        self._store = store
        self._queue: list[_Waiting] = []
        self._size = 0
        self._came, self._room = asyncio.Event(), asyncio.Event()
        self._room.set()

    async def room(self) -> None:
        """Wait until a further payload may be unpacked."""
        await self._room.wait()

    async def commit(self, payload: Payload) -> Committed:
        """Return once a payload is committed. Raises StoreError where nothing of it is kept."""
        done: asyncio.Future[Committed] = asyncio.get_running_loop().create_future()
        self._queue.append(_Waiting(payload, done))
        self._add(payload.size)
        self._came.set()
        return await done

    def _add(self, size: int) -> None:
        self._size += size
        if self._size > MOST_WAITING:
            self._room.clear()
        else:
            self._room.set()

    async def run(self) -> None:
        """Commit what waits, until this is cancelled."""
        while True:
            await self._came.wait()
            some, self._queue = self._queue[:MOST_TOGETHER], self._queue[MOST_TOGETHER:]
            if not self._queue:
                self._came.clear()
            await self._together(some)
            self._add(-sum(one.payload.size for one in some))

    async def _together(self, some: list[_Waiting]) -> None:
        try:
            found = await run_in_threadpool(self._store.commit, [one.payload for one in some])
        except Exception as error:  # whatever it is, each of those who wait is told of it
            for one in some:
                if not one.done.done():
                    one.done.set_exception(error)
            return
        for one, committed in zip(some, found, strict=True):
            if not one.done.done():  # its robot may be gone
                one.done.set_result(committed)
