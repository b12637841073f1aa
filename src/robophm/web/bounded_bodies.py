"""Bodies of requests, bounded: how large one may be at which address, how much of it may be other than words, and large
ones one at a time."""

from __future__ import annotations

import asyncio

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import Message, Receive, Scope

from robophm.web.access.roles import Role

MOST_BYTES = 1_000_000
"""Largest body of a request, but at the addresses of LARGER [bytes]."""

FILES, MOST_OF_FILES = "/api/new/files", 8_000_000_000
"""The one address that takes recordings, which are written to the disk as they come; and their most."""

LOGIN, MOST_OF_LOGIN = "/login", 10_000
"""The one address at which a body is read of whoever is not known, and its most."""

MOST_OF_DESIGN = 24_000_000
"""A design is 20 MB at most, and its line breaks take two letters in JSON: one of 100,000 parts has 11 MB."""

LARGER = {
    "/api/design/text": MOST_OF_DESIGN,
    "/api/design/check": MOST_OF_DESIGN,
    "/api/design/edits": MOST_OF_DESIGN,
    "/api/imports/legacy": MOST_OF_DESIGN,
    "/api/imports/parts-list": MOST_OF_DESIGN,
    "/api/maintenance/costs": 3_000_000,
    "/api/tasks/predict": 6_000_000,
    "/api/tasks/prognosis": 6_000_000,
    "/api/tasks/read": 12_000_000,
    FILES: MOST_OF_FILES,
}
"""The addresses at which a text, a file or thousands of legs come, and the most of each [bytes]."""

MOST_BUT_WORDS = 2_000_000
"""Largest part of a JSON body that is not within quotes, a quoted word counted as one [bytes].

Each value takes a byte of it at least, and in memory up to fifty times what it takes here: 100,000 values are one edit.
"""

LARGE = 100_000
"""Size from which bodies are taken one at a time [bytes]."""

MOST_WAITING, MOST_WAITING_OF_VIEWERS = 48_000_000, 2_000_000
"""Size of all large bodies that wait for their turn, and of the one that has it [bytes]: of all, and of viewers alone.

So those who may only look keep nobody waiting for more than a few seconds.
"""


def most_of(path: str, role: Role) -> int:
    """Return the size that a body of somebody in a role may have at an address [bytes]: of viewers none is larger."""
    if path == LOGIN:
        return MOST_OF_LOGIN
    return MOST_BYTES if role == "viewer" else LARGER.get(path, MOST_BYTES)


class BoundedBodies:
    """The bodies of all requests to a service; large ones take turns, for what is made of one is larger than it."""

    def __init__(self) -> None:
        self._turn = asyncio.Lock()
        self._waiting, self._of_viewers = 0, 0

    def of(self, scope: Scope, headers: Headers, receive: Receive, role: Role = "editor") -> BoundedBody:
        """Return the body of a request of somebody in a role, or of a program that may write."""
        json = "json" in headers.get("content-type", "").lower()
        return BoundedBody(self, receive, scope["path"], role, words=Words() if json else None)

    async def wait(self, size: int, role: Role) -> None:
        """Wait for a turn. Raises HTTPException where too much waits already."""
        of_viewer = size if role == "viewer" else 0
        if self._waiting + size > MOST_WAITING or self._of_viewers + of_viewer > MOST_WAITING_OF_VIEWERS:
            raise HTTPException(503, "other large requests are under way; try again later", {"retry-after": "10"})
        self._count(size, role)
        try:
            await self._turn.acquire()
        except asyncio.CancelledError:
            self._count(-size, role)
            raise

    def go_on(self, size: int, role: Role) -> None:
        """End a turn."""
        self._count(-size, role)
        self._turn.release()

    def _count(self, size: int, role: Role) -> None:
        self._waiting += size
        self._of_viewers += size if role == "viewer" else 0


class BoundedBody:
    """The body of one request, as it comes."""

    def __init__(self, bodies: BoundedBodies, receive: Receive, path: str, role: Role, words: Words | None) -> None:
        self._bodies, self._receive, self._words, self._role = bodies, receive, words, role
        self._most, self._is_kept = most_of(path, role), path != FILES
        self._size = 0
        self._has_turn = False

    async def receive(self) -> Message:
        """Return the next message; the last of a large body once it has its turn. Raises HTTPException."""
        message = await self._receive()
        piece = message.get("body", b"")
        self._size += len(piece)
        if self._size > self._most:
            raise HTTPException(413, f"the request is larger than {self._most / 1_000_000:,g} MB")
        if self._words and self._words.beside(piece) > MOST_BUT_WORDS:
            raise HTTPException(
                413, f"more than {MOST_BUT_WORDS / 1_000_000:,g} MB of the JSON are no texts; expected fewer values"
            )
        if self._is_kept and self._size > LARGE and not message.get("more_body") and not self._has_turn:
            await self._bodies.wait(self._size, self._role)
            self._has_turn = True
        return message

    def end(self) -> None:
        """Let the next one have its turn: this one is answered."""
        if self._has_turn:
            self._has_turn, self._is_kept = False, False
            self._bodies.go_on(self._size, self._role)


class Words:
    """JSON that comes in pieces: how much of it is beside the words, which is what takes memory."""

    def __init__(self) -> None:
        self._inside, self._half = False, b""
        self._beside = 0

    def beside(self, piece: bytes) -> int:
        """Return the bytes so far that are not within quotes, and one for each quoted word."""
        text = self._half + piece
        self._half = b"\\" * ((len(text) - len(text.rstrip(b"\\"))) % 2)  # what it stands before has not come
        text = text[: len(text) - len(self._half)].replace(b"\\\\", b"").replace(b'\\"', b"")
        parts = text.split(b'"')
        self._beside += sum(map(len, parts[self._inside :: 2])) + (len(parts) - self._inside) // 2
        self._inside ^= len(parts) % 2 == 0
        return self._beside
