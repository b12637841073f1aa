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

from robophm.core.errors import StoreError
from robophm.fleet.intake import Intake, RefusedError, said_of, token_in
from robophm.fleet.mqtt.listener import listen
from robophm.fleet.payload import MOST_BYTES
from robophm.fleet.store import FleetStore
from robophm.transports.mqtt import Address
from robophm.web.bounded_bodies import BoundedBodies

COUNTS_KEPT_EVERY = 1.0
"""Seconds between two moments at which what was refused is kept."""

_log = logging.getLogger("robophm")


def create_app(store: FleetStore, page: ASGIApp, broker: Address | None = None) -> Starlette:
    """Return the service of a fleet, to be run on any ASGI server; ``page`` answers all that is not for robots.

    With a ``broker``, reports are taken there too.
    """
    intake = Intake(store)
    reports = _Reports(intake)

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        work = [_keep_counts(store), intake.committer.run(), *([listen(intake, broker)] if broker else [])]
        tasks = [asyncio.create_task(one) for one in work]
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


class _Reports:
    """The reports of robots, as they come over HTTP."""

    def __init__(self, intake: Intake) -> None:
        self._intake = intake
        self._bodies = BoundedBodies()

    async def take(self, request: Request) -> Response:
        """Take a payload, and answer once it is committed."""
        try:
            token = token_in(request.headers.get("authorization", ""))
            robot = await self._intake.whose(token, request.path_params["robot"])  # before anything else is read
            done = await self._intake.commit(robot, await self._body(request, robot))
        except RefusedError as refused:
            raise HTTPException(refused.status, str(refused)) from None
        except ClientDisconnect:  # in the middle of it: nothing came, and nobody hears what is answered
            return Response(status_code=400)
        except StoreError as error:  # the robot keeps it, and tries again
            _log.error("%s", error)
            return JSONResponse({"message": f"nothing of it is kept: {error}"}, 503, {"retry-after": "10"})
        return JSONResponse(said_of(done))

    async def _body(self, request: Request, robot: str) -> bytes:
        length = request.headers.get("content-length", "0")
        if not length.isdecimal() or int(length) > MOST_BYTES:
            raise self._intake.too_large(robot)
        bounded = self._bodies.of(request.scope, request.headers, request.receive)
        try:
            return await Request(request.scope, bounded.receive).body()
        except HTTPException as error:
            raise (self._intake.too_large(robot) if error.status_code == 413 else error) from None
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
