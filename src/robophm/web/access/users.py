"""The users of the service, people with passwords and programs with tokens, of which only digests are kept."""

from __future__ import annotations

import hashlib
import hmac
import secrets
import time
import unicodedata
from dataclasses import dataclass
from typing import Literal

from robophm.core.errors import RobophmError, nearest
from robophm.web.access.file import AccessFile
from robophm.web.access.roles import ROLES, Role

SHORTEST_PASSWORD, LONGEST_PASSWORD = 15, 1000
"""Characters of a password: NIST SP 800-63B-4, 3.1.1.2, of one that is the only factor."""

LONGEST_NAME = 100

SESSION = 7 * 86400.0
"""Seconds after which somebody has to log in again."""

_COST = {"n": 1 << 14, "r": 8, "p": 5, "maxmem": 64 << 20, "dklen": 32}
"""The parameters of scrypt (RFC 7914), which take 16 MiB and some tenths of a second for each guess."""


@dataclass(frozen=True)
class User:
    """Somebody, or some program, that may use the service."""

    name: str
    role: Role
    kind: Literal["person", "token"]
    ends: float | None = None
    """When a token ends [s since the epoch]; None where it does not."""


class Users:
    """The users in an access file, and their sessions."""

    def __init__(self, file: AccessFile) -> None:
        self._file = file

    def __bool__(self) -> bool:
        """Return whether there is any user: then nobody else is let in."""
        return bool(self._file.run("SELECT 1 FROM user LIMIT 1"))

    def all(self) -> list[User]:
        """Return all users by name."""
        return [User(*row) for row in self._file.run("SELECT name, role, kind, ends FROM user ORDER BY name")]

    def add_person(self, name: str, role: str, password: str) -> None:
        """Add a person, or give one another role and password, whose sessions end. Raises RobophmError."""
        if not SHORTEST_PASSWORD <= len(password) <= LONGEST_PASSWORD:
            raise RobophmError(f"a password of {len(password)} characters; expected at least {SHORTEST_PASSWORD}")
        salt = secrets.token_bytes(16)
        self._add(name, role, "person", salt, _stretched(password, salt), None)

    def add_token(self, name: str, role: str, days: float | None = None) -> str:
        """Add a program and return its token, which is kept nowhere. Raises RobophmError."""
        token = f"robophm_{secrets.token_urlsafe(32)}"
        ends = None if days is None else time.time() + 86400 * days
        self._add(name, role, "token", b"", _digest(token), ends)
        return token

    def _add(self, name: str, role: str, kind: str, salt: bytes, secret: bytes, ends: float | None) -> None:
        if not name.strip() or len(name) > LONGEST_NAME or not name.isprintable():
            raise RobophmError(f"a name of {len(name)} characters; expected 1 to {LONGEST_NAME} that can be printed")
        if role not in ROLES:
            raise RobophmError(f"no role '{role}'{nearest(role, ROLES)}; expected {', '.join(ROLES)}")
        self._file.run("INSERT OR REPLACE INTO user VALUES (?, ?, ?, ?, ?, ?)", (name, role, kind, salt, secret, ends))

    def remove(self, name: str) -> None:
        """Remove a user, whose sessions end at once. Raises RobophmError where there is none of that name."""
        if not self._file.run("DELETE FROM user WHERE name = ? RETURNING name", (name,)):
            raise RobophmError(f"no user '{name}'{nearest(name, [one.name for one in self.all()])}")

    def log_in(self, name: str, password: str) -> str | None:
        """Return a new session of a person; None for a wrong name or password, which takes as long."""
        query = "SELECT salt, secret FROM user WHERE name = ? AND kind = 'person'"
        rows = self._file.run(query, (name[:LONGEST_NAME],))
        salt, secret = rows[0] if rows else (b"\0" * 16, b"")
        if not hmac.compare_digest(_stretched(password[:LONGEST_PASSWORD], salt), secret):
            return None
        session, now = secrets.token_urlsafe(32), time.time()
        self._file.run("DELETE FROM session WHERE ends <= ?", (now,))
        self._file.run("INSERT INTO session VALUES (?, ?, ?)", (_digest(session), name, now + SESSION))
        return session

    def of_session(self, session: str) -> User | None:
        """Return who has a session; None where it has ended, or there was none."""
        query = ("SELECT name, role, kind, user.ends FROM session JOIN user USING (name)"
                 " WHERE session.secret = ? AND session.ends > ?")  # fmt: skip
        rows = self._file.run(query, (_digest(session), time.time()))
        return User(*rows[0]) if rows else None

    def of_token(self, token: str) -> User | None:
        """Return which program has a token; None where it has ended, or there was none."""
        query = "SELECT name, role, kind, ends FROM user WHERE secret = ? AND kind = 'token' AND ifnull(ends, 1e99) > ?"
        rows = self._file.run(query, (_digest(token), time.time()))
        return User(*rows[0]) if rows else None

    def log_out(self, session: str) -> None:
        """End a session."""
        self._file.run("DELETE FROM session WHERE secret = ?", (_digest(session),))


def _digest(secret: str) -> bytes:
    """The digest of a secret that was made of 256 random bits, which needs no salt and no time."""
    return hashlib.sha256(secret.encode("utf-8", "replace")).digest()


def _stretched(password: str, salt: bytes) -> bytes:
    same = unicodedata.normalize("NFKC", password).encode("utf-8", "replace")
    return hashlib.scrypt(same, salt=salt, **_COST)
