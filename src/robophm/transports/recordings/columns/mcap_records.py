"""The records of MCAP files: their numbers, and which may lie where."""

from __future__ import annotations

import struct
from contextlib import suppress

from robophm.transports.recordings.columns.mcap_definitions import CHANNEL, SCHEMA

MAGIC = b"\x89MCAP0\r\n"
FOOTER, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, STATISTICS, DATA_END = 2, 5, 6, 7, 8, 11, 15
_HEADER, _ATTACHMENT, _METADATA = 1, 9, 12

PRIVATE = 128
"""The first opcode of records that are somebody's own."""

SUMMARY = (SCHEMA, CHANNEL, CHUNK_INDEX, 10, STATISTICS, 13, 14)
"""Opcodes in a summary."""

FOOTER_SIZE = 9 + 20 + len(MAGIC)


def belongs(opcode: int, content: memoryview, *, behind: bool) -> bool:
    """Whether a record that is no message, chunk, index or definition may be where messages lie, or ``behind`` them.

    One that was such before it was damaged seldom has the lengths of texts that another has.
    """
    if opcode in (FOOTER, *SUMMARY):
        return behind
    if opcode == _ATTACHMENT:
        return _as_long(content, 16, "IIQ", 4)
    if opcode in (_HEADER, _METADATA):
        return _as_long(content, 0, "II", 0)
    return opcode == DATA_END and len(content) >= 4


def _as_long(content: memoryview, at: int, lengths: str, rest: int) -> bool:
    """Whether there is room for values behind their lengths, which begin here, and for a rest."""
    with suppress(struct.error):
        for length in lengths:
            at += struct.calcsize("<" + length) + int(struct.unpack_from("<" + length, content, at)[0])
        return at + rest <= len(content)
    return False


def chunk_places(content: memoryview) -> list[int]:
    """The places of chunks, as far as the summary of a file says."""
    places: list[int] = []
    with suppress(struct.error):
        start = len(content) - FOOTER_SIZE
        position = int(struct.unpack_from("<Q", content, start + 9)[0]) if start >= 0 else start
        while 0 <= position < start:
            opcode, length = struct.unpack_from("<BQ", content, position)
            if opcode not in SUMMARY:
                break
            if opcode == CHUNK_INDEX:
                places += struct.unpack_from("<16xQ", content[: position + 9 + length], position + 9)
            position += 9 + length
    return places
