"""The routes of a fleet's service: each robot writes its own reports, and is answered once they are on the disk."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route
from starlette.types import ASGIApp

from robophm.core.errors import DataError, StoreError
from robophm.fleet.commit import Committed
from robophm.fleet.committer import Committer
from robophm.fleet.payload import MOST_BYTES, Payload, unpacked
from robophm.fleet.store import FleetStore
from robophm.web.bounded_bodies import BoundedBodies

COUNTS_KEPT_EVERY = 1.0
"""Seconds between two moments at which what was refused is kept."""

_log = logging.getLogger("robophm")


def create_app(store: FleetStore, page: ASGIApp) -> Starlette:
    """Return the service of a fleet, to be run on any ASGI server; ``page`` answers all that is not for robots."""
    reports = _Reports(store)

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        tasks = [asyncio.create_task(one) for one in (_keep_counts(store), reports.committer.run())]
        yield
        for one in tasks:
            one.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    routes = [
        Route("/healthz", _alive),
        Route("/robots/{robot}/reports", reports.take, methods=["POST"]),
        Mount("/", page),
    ]
    return Starlette(routes=routes, lifespan=lifespan, exception_handlers={HTTPException: _http, Exception: _our_fault})


async def _keep_counts(store: FleetStore) -> None:
    while True:
        await asyncio.sleep(COUNTS_KEPT_EVERY)
        with suppress(StoreError):
            await run_in_threadpool(store.keep_counts)


async def _alive(request: Request) -> Response:
    return PlainTextResponse("ok\n")


class _Refused(HTTPException):
    """What a robot sends is not taken; it is counted for the robot whose token it came with."""

    def __init__(self, status: int, why: str, robot: str = "", counted: str = "") -> None:
        super().__init__(status, why)
        self.robot, self.counted = robot, counted or why


class _Reports:
    """The reports of robots, as they come."""

    def __init__(self, store: FleetStore) -> None:
        self._store = store
        self.committer = Committer(store)
        self._bodies = BoundedBodies()
        self._one_at_a_time = asyncio.Lock()
        """Held while a payload is unpacked: it may be many times as large as its body."""

    async def take(self, request: Request) -> Response:
        """Take a payload, and answer once it is committed."""
        try:
            done = await self._taken(request)
        except _Refused as refused:
            self._store.refuse(refused.robot, refused.counted)
            raise
        except ClientDisconnect:  # in the middle of it: nothing came, and nobody hears what is answered
            return Response(status_code=400)
        except StoreError as error:  # the robot keeps it, and tries again
            _log.error("%s", error)
            return JSONResponse({"message": f"nothing of it is kept: {error}"}, 503, {"retry-after": "10"})
        said = {"epoch": done.epoch, "seq": done.seq}
        return JSONResponse({"committed": said, "new": done.new, "repeated": done.repeated})

    async def _taken(self, request: Request) -> Committed:
        robot = await self._whose(request)
        body = await self._body(request, robot)
        async with self._one_at_a_time:
            await self.committer.room()
            try:
                payload: Payload = await run_in_threadpool(unpacked, body)
            except DataError as error:
                raise _Refused(422, f"payload: {error}", robot, "malformed payload") from None
        if payload.robot != robot:
            why = f"payload: is of robot {payload.robot!r:.120}; the token is of {robot!r}"
            raise _Refused(403, why, robot, "payload of another robot")
        return await self.committer.commit(payload)

    async def _whose(self, request: Request) -> str:
        """The robot whose token it is, which must be the one of the address; before anything else is read."""
        kind, _, token = request.headers.get("authorization", "").partition(" ")
        robot = None
        if kind.lower() == "bearer":
            robot = await run_in_threadpool(self._store.robot_of, token.strip())
        if robot is None:
            raise _Refused(401, "expected a robot's token: Authorization: Bearer …", "", "no token, or a wrong one")
        asked = request.path_params["robot"]
        if asked != robot:
            why = f"the token is of {robot!r}, which may not write for {asked!r:.120}"
            raise _Refused(403, why, robot, "writing for another robot")
        return robot

    async def _body(self, request: Request, robot: str) -> bytes:
        too_large = _Refused(413, f"larger than {MOST_BYTES / 1e6:g} MB", robot)
        length = request.headers.get("content-length", "0")
        if not length.isdecimal() or int(length) > MOST_BYTES:
            raise too_large
        bounded = self._bodies.of(request.scope, request.headers, request.receive)
        try:
            return await Request(request.scope, bounded.receive).body()
        except HTTPException as error:
            raise (too_large if error.status_code == 413 else error) from None
        finally:
            bounded.end()


async def _http(request: Request, error: Exception) -> Response:
    if not isinstance(error, HTTPException):
        raise error
    words = {404: "there is nothing of that name; expected /robots/NAME/reports", 405: "expected POST"}
    said = {"message": words.get(error.status_code, str(error.detail))}
    headers = {**(error.headers or {}), **({"www-authenticate": "Bearer"} if error.status_code == 401 else {})}
    return JSONResponse(said, error.status_code, headers)


async def _our_fault(request: Request, error: Exception) -> Response:
    _log.error("request %s", request.url.path, exc_info=error)
    return JSONResponse({"message": "a fault within robophm; its log says where"}, 500)
