"""The guard of the service: no request from elsewhere, none too large, and a token where others can reach it.

A web site that a person visits could ask a service on that person's machine in their name. So requests must name this
host, writes and WebSockets must come from its own page, and what is answered may load nothing from elsewhere.
"""

from __future__ import annotations

import hmac
import json
from contextlib import suppress
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from urllib.parse import parse_qsl, urlencode, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MOST_BYTES = 24_000_000
"""Largest body of a request [bytes]: a design is 20 MB at most."""

FILES, MOST_OF_FILES = "/api/new/files", 8_000_000_000
"""The one address that takes larger ones, recordings, which are written to the disk as they come; and their most."""

WITHOUT_TOKEN = ("/healthz", "/readyz")
"""Addresses that a supervisor asks, whose answers tell nothing of the robot."""

COOKIE = "robophm_token"

SECURITY = {
    "content-security-policy": "default-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'; "
    "object-src 'none'",
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}
TOKEN_PAGE = b"""<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>robophm: token</title></head>
<body><main><h1>This service asks for its token</h1>
<p>It was printed when <code>robophm serve</code> was started. One that came with this address is not it.</p>
<form action="/"><label>Token <input type="password" name="token" required autocomplete="current-password"></label>
<button>Open</button></form></main></body></html>
"""
"""The page that asks a person for the token where the browser does not know it; programs are told in JSON."""

REPORT_POLICY = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'"
"""Content security policy of a stand-alone report, whose style is within."""


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address."""
    if host == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


class Guard:
    """Middleware around the whole service."""

    def __init__(self, app: ASGIApp, host: str, token: str | None) -> None:
        self._app = app
        self._open = not is_loopback(host)
        self._token = token
        if self._open and not token:
            raise ValueError("an address that others reach needs a token")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Refuse a request from elsewhere, or pass it on."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refused = self._refusal(scope, headers)
        if refused:
            await _refuse(scope, receive, send, *refused)
            return
        if scope["type"] == "websocket":
            await self._app(scope, receive, send)
            return
        if self._token and (asked := _without_token(scope, self._token)):
            await _welcome(send, asked, self._token, secure=scope.get("scheme") == "https")
            return

        async def answer(message: Message) -> None:
            if message["type"] == "http.response.start":
                said = MutableHeaders(scope=message)
                for name, value in SECURITY.items():
                    said.setdefault(name, value)
                said.setdefault("cache-control", _kept(scope["path"]))
            await send(message)

        await self._app(scope, _bounded(receive, _most(scope["path"])), answer)

    def _refusal(self, scope: Scope, headers: Headers) -> tuple[int, str] | None:
        host = headers.get("host", "")
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            name = ""
        if not self._open and not is_loopback(name):
            return 421, "this service is for its own machine; expected the host 127.0.0.1 or localhost"
        writes = scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD", "OPTIONS")
        origin = headers.get("origin")
        if writes and origin is not None and not _same(origin, host):
            return 403, "a page from elsewhere may not do this"
        if writes and headers.get("sec-fetch-site", "same-origin") not in ("same-origin", "none"):
            return 403, "a page from elsewhere may not do this"
        length = headers.get("content-length", "0")
        most = _most(scope["path"])
        if not length.isdecimal() or int(length) > most:
            return 413, f"the request is larger than {most // 1_000_000:,} MB"
        if self._token and scope["path"] not in WITHOUT_TOKEN and not self._knows(scope, headers):
            return 401, "expected the token that the service was started with: open its address with ?token=… once"
        return None

    def _knows(self, scope: Scope, headers: Headers) -> bool:
        said = [value for key, value in parse_qsl(scope["query_string"].decode("latin-1")) if key == "token"]
        kind, _, bearer = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer":
            said.append(bearer.strip())
        cookies: SimpleCookie = SimpleCookie()
        with suppress(CookieError):
            cookies.load(headers.get("cookie", ""))
        if COOKIE in cookies:
            said.append(cookies[COOKIE].value)
        return any(hmac.compare_digest(one.encode(), (self._token or "").encode()) for one in said)


def _most(path: str) -> int:
    return MOST_OF_FILES if path == FILES else MOST_BYTES


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


def _without_token(scope: Scope, token: str) -> str | None:
    """The address at which a page opened with the token goes on, so that the token stays in no history and no log."""
    pairs = parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
    if scope["method"] != "GET" or scope["path"].startswith("/api/") or ("token", token) not in pairs:
        return None
    rest = urlencode([pair for pair in pairs if pair[0] != "token"])
    return "/" + str(scope["path"]).lstrip("/\\") + (f"?{rest}" if rest else "")


async def _welcome(send: Send, location: str, token: str, *, secure: bool) -> None:
    cookie: SimpleCookie = SimpleCookie()
    cookie[COOKIE] = token
    said = cookie[COOKIE]
    for key, value in (("path", "/"), ("samesite", "Strict"), ("max-age", str(30 * 86400))):
        said[key] = value
    said["httponly"], said["secure"] = True, secure
    headers = [
        (b"location", location.encode("ascii", "ignore")),
        (b"set-cookie", said.OutputString().encode()),
        (b"cache-control", b"no-store"),
        (b"referrer-policy", b"no-referrer"),
    ]
    await send({"type": "http.response.start", "status": 303, "headers": headers})
    await send({"type": "http.response.body", "body": b""})


class TooLargeError(Exception):
    """The body goes on beyond what it may be."""


def _bounded(receive: Receive, most: int) -> Receive:
    """The same messages, as long as their bodies are not too large in all."""
    total = 0

    async def bounded() -> Message:
        nonlocal total
        message = await receive()
        total += len(message.get("body", b""))
        if total > most:
            raise TooLargeError
        return message

    return bounded


async def _refuse(scope: Scope, receive: Receive, send: Send, status: int, why: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 4000 + status, "reason": why[:100]})
        return
    asked = Headers(scope=scope).get("accept", "")
    if status == 401 and "text/html" in asked and not str(scope["path"]).startswith("/api/"):
        kind, body = b"text/html; charset=utf-8", TOKEN_PAGE
    else:
        kind, body = b"application/json", json.dumps({"message": why, "place": []}).encode()
    headers = [(b"content-type", kind), (b"content-length", str(len(body)).encode()), (b"cache-control", b"no-store")]
    headers += [(name.encode(), value.encode()) for name, value in SECURITY.items()]
    if status == 401:
        headers.append((b"www-authenticate", b"Bearer"))
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": body})
