"""The guard of the service: no request from elsewhere, none too large, and each only of whoever may.

A web site that a person visits could ask a service on that person's machine in their name. So requests must name this
host, writes and WebSockets must come from its own page, and what is answered may load nothing from elsewhere.
"""

from __future__ import annotations

import asyncio
import json
import re
import time
from collections.abc import Sequence
from urllib.parse import urlsplit

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers, MutableHeaders
from starlette.routing import BaseRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from robophm.core.errors import RobophmError
from robophm.web.access.changes import CHANGE, Change
from robophm.web.access.login_page import HEADERS, login_page
from robophm.web.access.proxies import is_loopback
from robophm.web.access.roles import LOOKING, may, role_needed
from robophm.web.access.users import User
from robophm.web.access.visitors import Visitors
from robophm.web.bounded_bodies import BoundedBodies, most_of

OPEN_TO_ALL = ("/healthz", "/readyz", "/login")
"""Addresses that a supervisor asks, whose answers tell nothing of the robot, and the one to log in at."""

LOOKED_AT_AGAIN = 10.0
"""Seconds after which it is looked again whether whoever watches live values still may."""

SECURITY = {
    "content-security-policy": "default-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'; "
    "object-src 'none'",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}

REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'"
"""Content security policy of a stand-alone report, whose style is within."""

ORIGIN = re.compile(r"https?://[A-Za-z0-9.-]+(:[0-9]{1,5})?|https?://\[[0-9a-fA-F:]+\](:[0-9]{1,5})?")
"""The origin of a page: scheme, host and port."""


def policy_within(origins: Sequence[str]) -> str:
    """Return the content security policy of a page that may be shown inside others, of these origins.

    Raises RobophmError where one of them is no origin, as ``https://grafana.example``.
    """
    for origin in origins:
        if not ORIGIN.fullmatch(origin):
            raise RobophmError(
                f"{origin}: expected the origin of a page, as https://grafana.example or http://10.0.0.5:3000"
            )
    allowed = " ".join(["'self'", *origins]) if origins else "'none'"
    return SECURITY["content-security-policy"].replace("frame-ancestors 'none'", f"frame-ancestors {allowed}")


class Guard:
    """Middleware around the whole service."""

    def __init__(self, app: ASGIApp, host: str, visitors: Visitors, routes: Sequence[BaseRoute]) -> None:
        self._app, self._visitors, self._routes = app, visitors, routes
        self._open = not is_loopback(host)
        self._bodies = BoundedBodies()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse a request from elsewhere, or of whoever may not, or pass it on."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        user = self._visitors.who(scope, headers)
        refused = self._refusal(scope, headers, user) or self._not_allowed(scope, user)
        if refused:
            await _refuse(scope, receive, send, *refused)
            return
        scope["user"] = user
        if scope["type"] == "websocket":
            await self._app(scope, receive, self._while_allowed(scope, headers, send))
            return
        change = self._change(scope, headers, user)
        body = self._bodies.of(scope, headers, receive, user.role if user else "viewer")

        begun = False

        async def answer(message: Message) -> None:
            nonlocal begun
            if message["type"] == "http.response.start":
                begun = True
                body.end()
                if change and message["status"] < 400:
                    await run_in_threadpool(self._visitors.changes.add, change)
                said = MutableHeaders(scope=message)
                for name, value in SECURITY.items():
                    said.setdefault(name, value)
                if self._visitors.is_secure(scope, headers):
                    said.setdefault("strict-transport-security", "max-age=31536000")
                said.setdefault("cache-control", _kept(scope["path"]))
            await send(message)

        token = CHANGE.set(change)
        try:
            await self._app(scope, body.receive, answer)
        except asyncio.CancelledError:  # the service ends, and this took too long for it
            if not begun:
                await _refuse(scope, receive, send, 503, "the service ends; try again when it is there again")
        finally:
            body.end()
            CHANGE.reset(token)

    def _refusal(self, scope: Scope, headers: Headers, user: User | None) -> tuple[int, str] | None:
        """Why a request is refused whoever asks."""
        host = headers.get("host", "")
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            name = ""
        if not self._open and not is_loopback(name) and not self._visitors.by_proxy(scope):
            return 421, "this service is for its own machine; expected the host 127.0.0.1 or localhost"
        writes = scope["type"] == "websocket" or scope["method"] not in LOOKING
        origin = headers.get("origin")
        if writes and origin is not None and not _same(origin, host):
            return 403, "a page from elsewhere may not do this"
        if writes and headers.get("sec-fetch-site", "same-origin") not in ("same-origin", "none"):
            return 403, "a page from elsewhere may not do this"
        length = headers.get("content-length", "0")
        most = most_of(scope["path"], user.role if user else "viewer")
        if not length.isdecimal() or int(length) > most:
            return 413, f"the request is larger than {most / 1_000_000:,g} MB"
        return None

    def _not_allowed(self, scope: Scope, user: User | None) -> tuple[int, str] | None:
        """Why whoever asks is refused."""
        if scope["path"] in OPEN_TO_ALL:
            return None
        if user is None:
            return 401, "expected somebody who is logged in, or a token: Authorization: Bearer …"
        needed = role_needed(scope, self._routes)
        if not may(user.role, needed):
            return 403, f"this is for the role {needed}; {user.name} has the role {user.role}"
        return None

    def _change(self, scope: Scope, headers: Headers, user: User | None) -> Change | None:
        """The change that a request makes, to be logged; None where it can make none."""
        if scope["method"] in LOOKING or not user or role_needed(scope, self._routes) == "viewer":
            return None
        what = f"{scope['method']} {scope['path']}"[:200]
        return Change(user.name, user.role, self._visitors.address_of(scope, headers), what)

    def _while_allowed(self, scope: Scope, headers: Headers, send: Send) -> Send:
        """Send what is to be sent as long as whoever asked may have it."""
        looked = time.monotonic()

        async def checked(message: Message) -> None:
            nonlocal looked
            if message["type"] == "websocket.send" and time.monotonic() - looked > LOOKED_AT_AGAIN:
                looked = time.monotonic()
                if self._visitors.who(scope, headers) is None:
                    message = {"type": "websocket.close", "code": 4401, "reason": "no longer logged in"}
            await send(message)

        return checked


def _kept(path: str) -> str:
    """The cache policy of an answer: what is built has its content in its name."""
    if path.startswith("/assets/"):
        return "public, max-age=31536000, immutable"
    return "no-store" if path.startswith(("/api/", "/metrics")) else "no-cache"


def _same(origin: str, host: str) -> bool:
    try:
        return urlsplit(origin).netloc.lower() == host.lower()
    except ValueError:
        return False


async def _refuse(scope: Scope, receive: Receive, send: Send, status: int, why: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 4000 + status, "reason": why[:100]})
        return
    asked = Headers(scope=scope).get("accept", "")
    if status == 401 and "text/html" in asked and not str(scope["path"]).startswith("/api/"):
        kind, body, policy = b"text/html; charset=utf-8", login_page().encode(), HEADERS["referrer-policy"]
    else:
        kind, body = b"application/json", json.dumps({"message": why, "place": []}).encode()
        policy = SECURITY["referrer-policy"]
    headers = [(b"content-type", kind), (b"content-length", str(len(body)).encode()), (b"cache-control", b"no-store")]
    said = {**SECURITY, "referrer-policy": policy}
    headers += [(name.encode(), value.encode()) for name, value in said.items()]
    if status == 401:
        headers.append((b"www-authenticate", b"Bearer"))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
