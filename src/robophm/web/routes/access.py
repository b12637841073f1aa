"""Access: the visitor, logging in and out, and the log of what was changed."""

from __future__ import annotations

from html import escape
from http.cookies import SimpleCookie
from typing import Annotated, Any
from urllib.parse import parse_qs

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from starlette.concurrency import run_in_threadpool

from robophm.web.access.changes import Change
from robophm.web.access.login_page import HEADERS, login_page
from robophm.web.access.roles import Role, needs
from robophm.web.access.users import SESSION, User
from robophm.web.access.visitors import Visitors, cookie_name, session_of
from robophm.web.shapes import Shape

router = APIRouter(tags=["access"])


def _visitors(request: Request) -> Visitors:
    visitors: Visitors = request.app.state.visitors
    return visitors


Visiting = Annotated[Visitors, Depends(_visitors)]
"""Whoever visits the service, in a route."""


class Visitor(Shape):
    """The user who asks, with their role."""

    name: str
    """Name of the user; empty where anybody may."""
    role: Role
    session: bool
    """Whether it is a session, which can be ended."""


class ChangedValue(Shape):
    """A value of the design that was changed."""

    place: str
    before: str | None
    """The value before as JSON, at most 200 characters of it; null where there was none."""
    after: str | None


class LoggedChange(Shape):
    """Something that was done to the robot's design or to its watching."""

    time: float
    """When it was done [s since the epoch]."""
    who: str
    """The name of the user; empty where anybody may, or nobody asked."""
    role: str
    address: str
    what: str
    values: list[ChangedValue]
    more: int
    """Number of values that were changed beside those."""


class Changes(Shape):
    """The latest changes, the latest first."""

    changes: list[LoggedChange]


@router.get("/api/access")
def get_access(request: Request) -> Visitor:
    """The user who asks, with their role."""
    user: User = request.scope["user"]
    return Visitor(name=user.name, role=user.role, session=bool(session_of(request.scope, request.headers)))


@router.get("/api/access/changes")
@needs("editor")
def get_changes(visitors: Visiting, most: Annotated[int, Query(ge=1, le=20_000)] = 200) -> Changes:
    """The latest changes: who did what, when and from where, and of the design each value before and after."""
    return Changes(changes=[_told(one) for one in visitors.changes.latest(most)])


@router.get("/login", include_in_schema=False)
def get_login() -> Response:
    """The page on which people log in."""
    return HTMLResponse(login_page(), headers=HEADERS)


@router.post("/login", include_in_schema=False)
@needs("viewer")
async def log_in(request: Request, visitors: Visiting) -> Response:
    """Log a person in, by name and password."""
    scope = request.scope
    said = parse_qs((await request.body()).decode("utf-8", "replace"))
    name, password = (said.get(key, [""])[0] for key in ("name", "password"))
    address = visitors.address_of(scope, request.headers)
    found = await visitors.log_in(name, password, address)
    if isinstance(found, float):
        if found:
            words = f"Too many wrong passwords from {escape(address)}: try again in {found:.0f} s"
            return HTMLResponse(login_page(words), 429, {**HEADERS, "retry-after": f"{found:.0f}"})
        return HTMLResponse(login_page("This name and password are not right"), 401, HEADERS)
    await run_in_threadpool(visitors.changes.add, Change(name, "", address, "logged in"))
    answer = RedirectResponse("./", 303, HEADERS)
    _set_cookie(answer, request, visitors, found, SESSION)
    return answer


@router.post("/logout", include_in_schema=False)
@needs("viewer")
def log_out(request: Request, visitors: Visiting) -> Response:
    """End the session of whoever asks."""
    visitors.users.log_out(session_of(request.scope, request.headers))
    answer = RedirectResponse("./login", 303, HEADERS)
    _set_cookie(answer, request, visitors, "", 0.0)
    return answer


def _set_cookie(answer: Response, request: Request, visitors: Visitors, session: str, seconds: float) -> None:
    cookie: SimpleCookie = SimpleCookie()
    name = cookie_name(request.scope)
    cookie[name] = session
    attributes: dict[str, Any] = {"path": "/", "samesite": "Strict", "max-age": f"{seconds:.0f}", "httponly": True,
                                  "secure": visitors.is_secure(request.scope, request.headers)}  # fmt: skip
    for key, value in attributes.items():
        cookie[name][key] = value
    answer.headers["set-cookie"] = cookie[name].OutputString()


def _told(one: Change) -> LoggedChange:
    values = [ChangedValue(place=place, before=before, after=after) for place, before, after in one.values]
    return LoggedChange(time=one.time, who=one.who, role=one.role, address=one.address, what=one.what, values=values,
                        more=one.more)  # fmt: skip
