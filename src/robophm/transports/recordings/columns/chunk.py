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
    """The place of its record."""
    start: int
    end: int
    """The end of its content."""
    compression: str
    size: int
    """Bytes of its content, unpacked."""
    checksum: int
    """0 where it has none."""
    indices: dict[int, int] | None
    """The places in the file of the index of its messages, by connection; None where there is none."""
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


class UnknownError(DamageError):
    """Something is not as it was known to be, and may be right nevertheless: it is not believed, nor called damaged."""


def distinct(offsets: NDArray[Any], most: int) -> bool:
    """Whether no two are the same and there are no more than can be; as a rule they rise."""
    if len(offsets) > most:
        return False
    return bool((offsets[1:] > offsets[:-1]).all()) or len(np.unique(offsets)) == len(offsets)
