"""The service put together: routes, the built page, errors in words, and the guard around all of it."""

from __future__ import annotations

import json
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

from fastapi import APIRouter, FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, JSONResponse
from fastapi.routing import APIRoute
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.middleware.gzip import GZipMiddleware
from starlette.requests import ClientDisconnect
from starlette.staticfiles import StaticFiles

from robophm.core.errors import RobophmError
from robophm.core.registry import load_plug, plugs
from robophm.design.located_error import LocatedError
from robophm.web import routes
from robophm.web.access.roles import role_of
from robophm.web.guard import Guard, policy_within
from robophm.web.service import Service, Settings
from robophm.web.shapes import Trouble
from robophm.web.workspace import OutsideError, StaleError

STATIC = Path(__file__).with_name("static")
"""The built page; not in git."""

DESCRIPTION = (
    "One robot's design, analysis, monitoring and tasks. Times are in hours, samples' times in seconds since the "
    "epoch, hazard rates in 1/h. Live values come over the WebSocket /api/live in binary frames (docs/guides/page.md)."
)


GUARDED: dict[int | str, dict[str, Any]] = {
    401: {"model": Trouble, "description": "Nobody is logged in, and no token is right"},
    403: {"model": Trouble, "description": "For another role, or asked by a page from elsewhere"},
    413: {"model": Trouble, "description": "Larger than it may be"},
    422: {"model": Trouble, "description": "Refused, and why"},
    503: {"model": Trouble, "description": "Too many large requests are under way"},
}
"""Responses that any request may get."""


def create_app(settings: Settings) -> FastAPI:
    """Return the service of one robot. Raises DesignError, StoreError."""
    service = Service(settings)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        yield
        service.close()

    app = api(lifespan=lifespan)
    app.state.service, app.state.visitors = service, service.visitors
    if (STATIC / "index.html").is_file():
        policy = {"content-security-policy": policy_within(settings.embed)}
        app.add_api_route("/wall", lambda: FileResponse(STATIC / "index.html", headers=policy), include_in_schema=False)
        app.mount("/", StaticFiles(directory=STATIC, html=True), name="page")
    else:
        app.add_api_route("/", _unbuilt, include_in_schema=False)
    app.add_middleware(GZipMiddleware, minimum_size=2000, compresslevel=5)
    every = [route for router in routers() for route in router.routes]
    app.add_middleware(Guard, host=settings.host, visitors=service.visitors, routes=every)
    return app


def api(**more: Any) -> FastAPI:
    """Return the routes alone, as the OpenAPI schema describes them."""
    app = FastAPI(
        title="robophm", version=version("robophm"), description=DESCRIPTION, docs_url=None, redoc_url=None,
        openapi_url="/api/openapi.json", **more,
    )  # fmt: skip
    for router in routers():
        for route in router.routes:
            if isinstance(route, APIRoute):
                route.openapi_extra = {**(route.openapi_extra or {}), "x-role": role_of(route)}
        app.include_router(router, responses=GUARDED)
    app.add_exception_handler(RobophmError, _refused)
    app.add_exception_handler(RequestValidationError, _misspelt)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(RecursionError, _too_deep)
    app.add_exception_handler(UnicodeEncodeError, _no_text)
    app.add_exception_handler(ClientDisconnect, _left)
    app.add_exception_handler(Exception, _our_fault)
    return app


def routers() -> list[APIRouter]:
    """Return the routes of each subject, other packages' among them."""
    return [load_plug(routes.__name__, name, "file of routes").router for name in plugs(routes.__name__)]


def write_schema(path: str) -> None:
    """Write what the routes are into a file, as the page's types are made of it."""
    text = json.dumps(api().openapi(), indent=1, ensure_ascii=False) + "\n"
    Path(path).write_text(text, encoding="utf-8")


def _said(status: int, message: str, place: tuple[str, ...] = ()) -> JSONResponse:
    return JSONResponse({"message": message, "place": list(place)}, status)


async def _refused(request: Request, error: Exception) -> JSONResponse:
    if isinstance(error, StaleError):
        service: Service = request.app.state.service
        current = (await run_in_threadpool(service.design_state)).model_dump(mode="json")
        yours = int((await _json(request)).get("revision", 0))  # which may have come as true or 1.0
        return JSONResponse({"message": str(error), "place": [], "yours": yours, "current": current}, 409)
    if isinstance(error, OutsideError):
        said = {"message": str(error), "place": [], "digest": error.digest, "changes": list(error.changes)}
        return JSONResponse(said, 409)
    return _said(422, str(error), error.place if isinstance(error, LocatedError) else ())


async def _json(request: Request) -> dict[str, Any]:
    try:
        found = await request.json()
    except (ValueError, RuntimeError):
        return {}
    return found if isinstance(found, dict) else {}


async def _misspelt(request: Request, error: Exception) -> JSONResponse:
    if not isinstance(error, RequestValidationError):
        raise error
    first = error.errors()[0]
    where = " / ".join(str(step) for step in first["loc"])
    return _said(422, f"{where}: {first['msg']}")


async def _http(request: Request, error: Exception) -> JSONResponse:
    if not isinstance(error, HTTPException):
        raise error
    if error.status_code == 400:  # a body that is not even JSON
        return _said(422, "the body cannot be read; expected JSON")
    words = {404: "there is nothing of that name", 405: "this cannot be done here"}
    response = _said(error.status_code, words.get(error.status_code, str(error.detail)))
    response.headers.update(error.headers or {})
    return response


async def _too_deep(request: Request, error: Exception) -> JSONResponse:
    return _said(422, "what was sent is nested too deeply")


async def _no_text(request: Request, error: Exception) -> JSONResponse:
    return _said(422, "what was sent has half characters in it; expected Unicode")


async def _left(request: Request, error: Exception) -> JSONResponse:
    return _said(400, "who asked has left")  # which nobody hears


async def _our_fault(request: Request, error: Exception) -> JSONResponse:
    logging.getLogger("robophm").error("request %s", request.url.path, exc_info=error)
    return _said(500, "a fault within robophm; its log says where")


async def _unbuilt() -> JSONResponse:
    return _said(503, "the page is not built; expected `python -m build`, or `npm ci && npm run build` in ui/")
