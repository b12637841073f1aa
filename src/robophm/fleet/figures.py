"""The figures of a report as a fleet's store keeps them: in single precision, with a checksum."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Sequence

from robophm.core.errors import StoreError

_SINGLE = 3.4028234e38
"""The largest number in single precision."""


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


def present_sum(ledger: bytes, report: bytes) -> int:
    """Return the checksum of a present state, of its ledger and report as they are kept."""
    return zlib.crc32(report, zlib.crc32(ledger))


def must_be_kept(store: str, robot: str, ledger: bytes, report: bytes, told: int) -> None:
    """Raise StoreError where a present state is not what was kept; ``told``: its checksum."""
    if present_sum(ledger, report) != told:
        raise StoreError(f"{store}: the ledger of {robot} is damaged: its checksum is another")


def _sum(key: tuple[int, int, int], time: int, body: bytes) -> int:
    return zlib.crc32(body, zlib.crc32(struct.pack("<4q", *key, time)))
