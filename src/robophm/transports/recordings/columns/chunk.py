"""A chunk of messages: where it lies in a file, and what the file's index says of it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.pieces import DamageError


class Chunk(NamedTuple):
    """A chunk of messages in a file, and what the file's index knows of it."""

    first: int
    last: int
    """Earliest and latest receipt time [ns]."""
    offset: int
    """The offset of its record in the file."""
    start: int
    end: int
    """The offsets at which its content begins and ends in the file."""
    compression: str
    size: int
    """The size of its content when unpacked [bytes]."""
    checksum: int
    """The checksum of its content; 0 where it has none."""
    indices: dict[int, int] | None
    """The offset of the index of each connection's messages in the file; None where the chunk has no index."""
    behind: int = 0
    """The end of those; 0 where that is not known."""
    cut: bool = False
    """Whether the end of its content is missing."""

    @property
    def packed(self) -> bool:
        """Whether its content has to be unpacked."""
        return self.compression not in ("", "none")


Place = tuple[Chunk, int, int]
"""A chunk, and where in a buffer what was unpacked of it begins and ends."""


class Asked(NamedTuple):
    """The part of a chunk that is asked for."""

    chunk: Chunk
    content: bool
    """Whether anything but its index."""
    sparse: bool
    """Whether no more of it than single messages."""
    size: int
    """Bytes that this takes, about."""

    @property
    def unpacks(self) -> bool:
        """Whether that has to be unpacked."""
        return self.content and self.chunk.packed


class UnknownError(DamageError):
    """Raised where an index has a form that this reader does not know, which a newer writer may use.

    Such an index is not used, and nothing is noted as damaged.
    """


def distinct(offsets: NDArray[Any], most: int) -> bool:
    """Whether no two are the same and there are no more than can be; as a rule they rise."""
    if len(offsets) > most:
        return False
    return bool((offsets[1:] > offsets[:-1]).all()) or len(np.unique(offsets)) == len(offsets)


def index_of(chunk: Chunk) -> tuple[int, int]:
    """Return where the index behind a chunk begins and ends, as far as that is known."""
    begin = min(chunk.indices.values()) if chunk.indices else 0
    return begin, max(begin + 1, chunk.behind) if begin else 0
