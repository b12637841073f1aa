"""Visitors of the service: who has a session, a token, or a proxy that names them, or anybody where all may."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from http.cookies import CookieError, SimpleCookie

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.types import Scope

from robophm.web.access.changes import ChangeLog
from robophm.web.access.file import AccessFile
from robophm.web.access.guesses import EVERY, Guesses
from robophm.web.access.proxies import Proxies
from robophm.web.access.users import User, Users

MOST_GUESSING = 20
"""Passwords that may wait to be looked at, one at a time."""

ANYBODY = User("", "editor", "person")
"""Whoever asks a service that is for its own machine, and has no users."""


class Visitors:
    """All that decides who asks, and whether they may."""

    def __init__(self, file: AccessFile, *, reached_by_others: bool, proxies: Proxies) -> None:
        self.users, self.changes, self.guesses, self.proxies = Users(file), ChangeLog(file), Guesses(), proxies
        self._reached_by_others = reached_by_others
        self._one_at_a_time = asyncio.Lock()
        self._guessing = 0

    @property
    def known_alone(self) -> bool:
        """Return whether only those who are known are let in."""
        return self._reached_by_others or bool(self.proxies) or bool(self.users)

    def who(self, scope: Scope, headers: Headers) -> User | None:
        """Return who asks; None where that is nobody who may."""
        if not self.known_alone:
            return ANYBODY
        kind, _, token = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer":
            return self.users.of_token(token.strip())
        if session := session_of(scope, headers):
            return self.users.of_session(session)
        return self.proxies.user(_peer(scope), headers)

    def address_of(self, scope: Scope, headers: Headers) -> str:
        """Return the address from which somebody asks, as far as proxies that are believed say it."""
        return self.proxies.address_of(_peer(scope), headers)

    def by_proxy(self, scope: Scope) -> bool:
        """Return whether a proxy that is believed passes the request on."""
        return self.proxies.believed(_peer(scope))

    def is_secure(self, scope: Scope, headers: Headers) -> bool:
        """Return whether nobody on the way can read the request."""
        return scope.get("scheme") in ("https", "wss") or self.proxies.is_secure(_peer(scope), headers)

    async def log_in(self, name: str, password: str, address: str) -> str | float:
        """Return a new session; the seconds to wait where an address may not try now; 0.0 where it was wrong."""
        if (wait := self.guesses.wait(address)) > 0:
            return wait
        if self._guessing >= MOST_GUESSING:
            return 1.0
        self.guesses.wrong(address)  # until it is known to be right, so that many at once are no way around
        self._guessing += 1
        try:
            async with self._one_at_a_time:
                session = await run_in_threadpool(self.users.log_in, name, password)
        finally:
            self._guessing -= 1
        if session is None:
            if self.guesses.wait(address) > 0:
                logging.getLogger("robophm").warning("wrong passwords: %s has to wait %.0f s", address, EVERY)
            return 0.0
        self.guesses.right(address)
        return session


def session_of(scope: Scope, headers: Headers) -> str:
    """Return the session that a browser shows; "" where it shows none."""
    cookies: SimpleCookie = SimpleCookie()
    with suppress(CookieError):
        cookies.load(headers.get("cookie", ""))
    found = cookies.get(cookie_name(scope))
    return found.value if found else ""


def cookie_name(scope: Scope) -> str:
    """Return the name of the cookie: browsers keep the cookies of all ports of a machine together."""
    return f"robophm-{(scope.get('server') or ('', 0))[1]}"


def _peer(scope: Scope) -> str:
    return str((scope.get("client") or ("", 0))[0])
