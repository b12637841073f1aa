"""The taking in of payloads, whatever carries them: whose they are, what they say, and what is counted as refused."""

from __future__ import annotations

import asyncio

from starlette.concurrency import run_in_threadpool

from robophm.core.errors import DataError, RobophmError
from robophm.fleet.commit import Committed
from robophm.fleet.committer import Committer
from robophm.fleet.payload import MOST_BYTES, Payload, unpacked
from robophm.fleet.store import FleetStore


class RefusedError(RobophmError):
    """The refusal of what a robot sends, for a reason that is counted."""

    def __init__(self, status: int, why: str, robot: str = "", counted: str = "") -> None:
        """``status``: as of HTTP; ``robot``: whose token it came with, where that is known."""
        super().__init__(why)
        self.status, self.robot, self.counted = status, robot, counted or why


class Intake:
    """Takes in payloads of robots that show their tokens; what is refused is counted."""

    def __init__(self, store: FleetStore) -> None:
        self._store = store
        self.committer = Committer(store)
        self._one_at_a_time = asyncio.Lock()
        """Held while a payload is unpacked: it may be many times as large as its body."""

    async def whose(self, token: str | None, asked: str) -> str:
        """Return the robot whose token it is, which must be the one that is asked for. Raises RefusedError."""
        robot = await run_in_threadpool(self._store.robot_of, token) if token is not None else None
        if robot is None:
            raise self.refused(401, "expected a robot's token: Authorization: Bearer …", "", "no token, or a wrong one")
        if asked != robot:
            why = f"the token is of {robot!r}, which may not write for {asked!r:.120}"
            raise self.refused(403, why, robot, "writing for another robot")
        return robot

    async def commit(self, robot: str, body: bytes) -> Committed:
        """Return once a robot's payload is committed. Raises RefusedError, StoreError where nothing of it is kept."""
        if len(body) > MOST_BYTES:
            raise self.too_large(robot)
        async with self._one_at_a_time:
            await self.committer.room()
            try:
                payload: Payload = await run_in_threadpool(unpacked, body)
            except DataError as error:
                raise self.refused(422, f"payload: {error}", robot, "malformed payload") from None
        if payload.robot != robot:
            why = f"payload: is of robot {payload.robot!r:.120}; the token is of {robot!r}"
            raise self.refused(403, why, robot, "payload of another robot")
        return await self.committer.commit(payload)

    def too_large(self, robot: str) -> RefusedError:
        """Return the refusal of a body that is too large, counted."""
        return self.refused(413, f"larger than {MOST_BYTES / 1e6:g} MB", robot)

    def refused(self, status: int, why: str, robot: str = "", counted: str = "") -> RefusedError:
        """Return a refusal, counted."""
        error = RefusedError(status, why, robot, counted)
        self._store.refuse(error.robot, error.counted)
        return error


def token_in(authorization: str) -> str | None:
    """Return the token of ``Bearer …``; None where there is none."""
    kind, _, token = authorization.partition(" ")
    return token.strip() if kind.lower() == "bearer" else None


def said_of(done: Committed) -> dict[str, object]:
    """Return what is answered once a payload is committed."""
    return {"committed": {"epoch": done.epoch, "seq": done.seq}, "new": done.new, "repeated": done.repeated}
