"""The interface of places where recordings lie that are no files of this machine; each plug in ``places/`` is one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

Range = tuple[int, int]
"""Begin and end of some bytes of a file."""


class RemoteFile(Protocol):
    """A file in such a place."""

    size: int
    """The number of its bytes."""
    changed: float
    """The time of its last change [s since 1970]."""

    def parts(self, ranges: Sequence[Range]) -> Iterator[tuple[int, bytes]]:
        """Yield where some bytes of these ranges begin, and the bytes, in any order.

        Raises SourceError where they cannot be had, and RangesError where the place has files as a whole alone.
        """

    def whole(self) -> Iterator[bytes]:
        """Yield all bytes, part by part. Raises SourceError where they cannot be had."""


class RangesError(Exception):
    """Raised where a place has no ranges of bytes to give."""


@dataclass(frozen=True)
class Place:
    """A kind of place; each plug has one in ``PLACE``."""

    schemes: tuple[str, ...]
    """Schemes of the addresses of its files."""
    open: Callable[[str], RemoteFile]
    """The file at an address. Raises SourceError where there is none, or it cannot be read."""


def without_query(address: str) -> str:
    """Return an address as it may be shown: without a query, which may let anybody read, and without a password."""
    scheme, _, rest = address.partition("?")[0].partition("://")
    host, slash, path = rest.partition("/")
    return f"{scheme}://{host.rpartition('@')[2]}{slash}{path}"
