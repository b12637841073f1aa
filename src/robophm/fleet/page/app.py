"""The routes of the fleet's page: viewers look, after they have logged in where others reach the service."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated, Literal

from fastapi import FastAPI, Query, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import HTMLResponse, JSONResponse
from starlette.exceptions import HTTPException
from starlette.middleware.gzip import GZipMiddleware

from robophm.core.errors import RobophmError, StoreError
from robophm.core.signal import HOUR
from robophm.fleet.page.listing import Asked, Order, count, groups, lines, totals
from robophm.fleet.page.proposed import proposal_page, proposals_page
from robophm.fleet.page.views import (
    AT_ONCE,
    Epoch,
    Fleet,
    Robot,
    days_page,
    fleet_page,
    groups_page,
    robot_page,
    silent_since,
)
from robophm.fleet.payload import Ahead
from robophm.fleet.proposals import proposal, proposals
from robophm.fleet.questions import present, refused_of_nobody, status
from robophm.fleet.robot_history import RobotHistory, history
from robophm.fleet.store import FleetStore
from robophm.fleet.trend import trend
from robophm.report.markup import Html
from robophm.report.page import page
from robophm.web.access.file import AccessFile, access_path
from robophm.web.access.proxies import Proxies, is_loopback
from robophm.web.access.visitors import Visitors
from robophm.web.guard import REPORT_POLICY, Guard
from robophm.web.routes import access

POINTS = 300
"""Points of a curve, at most."""

SPAN = 30 * 24 * HOUR
"""The time before a robot's newest report, and before now of all robots, that is drawn [ns]."""

Horizon = Literal["24", "168", "720"]


def page_app(store: FleetStore, beside: Path, host: str, proxies: Proxies) -> FastAPI:
    """Return the page, guarded; who may use it is kept beside a path, as of a robot's page."""
    visitors = Visitors(AccessFile(access_path(beside)), reached_by_others=not is_loopback(host), proxies=proxies)
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    app.state.visitors = visitors
    app.include_router(access.router)
    pages = _Pages(store)
    app.add_api_route("/", pages.fleet, response_class=HTMLResponse)
    app.add_api_route("/groups", pages.groups, response_class=HTMLResponse)
    app.add_api_route("/days", pages.days, response_class=HTMLResponse)
    app.add_api_route("/robot", pages.robot, response_class=HTMLResponse)
    app.add_api_route("/proposals", pages.proposals, response_class=HTMLResponse)
    app.add_api_route("/proposal", pages.proposal, response_class=HTMLResponse)
    app.add_exception_handler(RequestValidationError, _misspelt)
    app.add_exception_handler(RobophmError, _refused)
    app.add_exception_handler(HTTPException, _http)
    app.add_middleware(GZipMiddleware, minimum_size=2000, compresslevel=5)
    app.add_middleware(Guard, host=host, visitors=visitors, routes=app.router.routes)
    return app


class _Pages:
    def __init__(self, store: FleetStore) -> None:
        self._store = store

    def fleet(
        self, horizon: Horizon = "168", order: Order = "worst",
        search: Annotated[str, Query(max_length=100)] = "",
        design: Annotated[str | None, Query(max_length=1000)] = None,
        site: Annotated[str | None, Query(max_length=100)] = None,
        start: Annotated[int, Query(ge=0, le=10**9)] = 0,
    ) -> HTMLResponse:  # fmt: skip
        """The list."""
        store, now, asked = self._store, time.time_ns(), Asked(float(horizon), order, search.strip(), design, site)
        found, of = lines(store, asked, start, AT_ONCE), count(store, asked)
        all_of_them = totals(store, asked.horizon, silent_since(now))
        return _answer(fleet_page(Fleet(asked, start, found, of, all_of_them, refused_of_nobody(store), now)))

    def groups(self, by: Literal["design", "site"], horizon: Horizon = "168") -> HTMLResponse:
        """All robots by design or site."""
        now = time.time_ns()
        found = groups(self._store, by, float(horizon), silent_since(now))
        return _answer(groups_page(by, found, float(horizon), now))

    def days(self, horizon: Horizon = "168") -> HTMLResponse:
        """The last days of all robots together."""
        now = time.time_ns()
        return _answer(days_page([*trend(self._store, float(horizon), now - SPAN, now)], float(horizon), now))

    def robot(self, name: Annotated[str, Query(max_length=100)]) -> HTMLResponse:
        """One robot."""
        store = self._store
        try:
            number = store.number_of(name)
        except RobophmError as error:
            return _answer(page("No such robot", [str(error)]), 404)
        (said,) = status(store, name)
        ((site,),) = store.rows("SELECT site FROM robot WHERE number = ?", (number,))
        epochs = [Epoch(*row) for row in store.rows(
            "SELECT number, name, reports, thinned, missing FROM epoch WHERE robot = ? ORDER BY number DESC LIMIT 20",
            (number,),
        )]  # fmt: skip
        past: RobotHistory = history(store, name, None if said.time is None else said.time - SPAN, None, POINTS)
        whole = (present(store, name) or ("", None))[1] or {}
        ahead = [Ahead(one["horizon"], one["sensor_based_failure"], one.get("first"), one.get("share"))
                 for one in whole.get("failure_within", ())]  # fmt: skip
        return _answer(robot_page(Robot(said, site, ahead, whole.get("time"), epochs, past, time.time_ns())))

    def proposals(self) -> HTMLResponse:
        """All proposals."""
        return _answer(proposals_page(proposals(self._store)))

    def proposal(self, number: Annotated[int, Query(ge=1, le=10**9)]) -> HTMLResponse:
        """One proposal."""
        try:
            return _answer(proposal_page(proposal(self._store, number)))
        except StoreError:
            raise
        except RobophmError as error:
            return _answer(page("No such proposal", [str(error)]), 404)


async def _misspelt(_: Request, error: Exception) -> HTMLResponse:
    assert isinstance(error, RequestValidationError)
    first = error.errors()[0]
    return _answer(page("Not understood", [f"{first['loc'][-1]}: {first['msg']}"]), 422)


async def _refused(_: Request, error: Exception) -> HTMLResponse:
    """A store that cannot be read now, or is damaged."""
    return _answer(page("The fleet cannot be shown", [str(error)]), 503)


async def _http(_: Request, error: Exception) -> JSONResponse:
    """What is no page: mostly a robot that was told another address."""
    assert isinstance(error, HTTPException)
    words = {404: "there is nothing of that name; expected /robots/NAME/reports of a robot, or / for the page"}
    return JSONResponse({"message": words.get(error.status_code, str(error.detail))}, error.status_code, error.headers)


def _answer(html: Html, status_code: int = 200) -> HTMLResponse:
    return HTMLResponse(html, status_code, {"content-security-policy": REPORT_POLICY, "cache-control": "no-store"})
