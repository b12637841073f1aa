"""The figures of a report as a fleet's store keeps them: in single precision, with a checksum."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import StoreError

_SINGLE = 3.4028234e38
"""The largest number in single precision."""

_NAN = struct.pack("<f", math.nan)


def figures_as_bytes(key: tuple[int, int, int], time: int, figures: Sequence[float]) -> bytes:
    """Return figures as they are kept, in single precision; a checksum of them, key and time is at their end."""
    body = struct.pack(f"<{len(figures)}f", *(math.copysign(math.inf, one) if abs(one) > _SINGLE else one
                                              for one in figures))  # fmt: skip
    return body + struct.pack("<I", _sum(key, time, body))


def figures_of_bytes(key: tuple[int, int, int], time: int, kept: bytes) -> tuple[float, ...]:
    """Return figures that were kept. Raises StoreError where they are not those."""
    body, told = kept[:-4], kept[-4:]
    if len(told) != 4 or len(body) % 4 or struct.unpack("<I", told)[0] != _sum(key, time, body):
        raise StoreError(f"report {key[2]} of epoch {key[1]} of robot {key[0]} is damaged: its checksum is another")
    return struct.unpack(f"<{len(body) // 4}f", body)


def figures_of_rows(keys: NDArray[np.int64], kept: Sequence[bytes]) -> NDArray[np.float32]:
    """Return the figures of many reports that were kept, a row each, NaN where one has fewer than another.

    ``keys``: robot, epoch, number and time of each, of shape (reports, 4). Raises StoreError as ``figures_of_bytes``.
    """
    packed, longest = memoryview(keys.astype("<i8").tobytes()), max(map(len, kept), default=4)
    for at, one in enumerate(kept):
        told = zlib.crc32(one[:-4], zlib.crc32(packed[32 * at : 32 * at + 32]))
        if len(one) % 4 or told.to_bytes(4, "little") != one[-4:]:
            figures_of_bytes((int(keys[at, 0]), int(keys[at, 1]), int(keys[at, 2])), int(keys[at, 3]), one)
    rows = b"".join([one[:-4] + _NAN * ((longest - len(one)) // 4) for one in kept])
    return np.frombuffer(rows, "<f4").reshape(len(kept), longest // 4 - 1)


def present_sum(ledger: bytes, report: bytes) -> int:
    """Return the checksum of a present state, of its ledger and report as they are kept."""
    return zlib.crc32(report, zlib.crc32(ledger))


def must_be_kept(store: str, robot: str, ledger: bytes, report: bytes, told: int) -> None:
    """Raise StoreError where a present state is not what was kept; ``told``: its checksum."""
    if present_sum(ledger, report) != told:
        raise StoreError(f"{store}: the ledger of {robot} is damaged: its checksum is another")


def _sum(key: tuple[int, int, int], time: int, body: bytes) -> int:
    return zlib.crc32(body, zlib.crc32(struct.pack("<4q", *key, time)))
