"""What tests of bad files share: how they are damaged, and what is read of them."""

from __future__ import annotations

import struct
import tracemalloc
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns import Block, read_columns

from ...conftest import SIGNALS
from ..made import T0, rewrite_mcap

Write = Callable[..., Path]
SIGNAL = "/t.temperature"


def in_chunks(path: Path, **options: Any) -> Path:
    """Some ten messages a chunk."""
    return rewrite_mcap(path, path.with_name("chunks.mcap"), chunk_size=600, **options)


def attempt(path: Path, *signals: str) -> tuple[list[Block], Counter[str]] | SourceError:
    """All blocks and the notes, or why there are none."""
    try:
        columns = read_columns(path, signals)
        return list(columns), columns.notes
    except SourceError as error:
        return error


def values(blocks: list[Block]) -> list[float]:
    return [value for block in blocks for value in block["/t"].values["temperature"].tolist()]


def records(content: bytes, opcode: int) -> list[int]:
    """Where the records of this kind begin."""
    found, position = [], 8
    while position + 9 <= len(content) - 8:
        kind, length = struct.unpack_from("<BQ", content, position)
        found += [position] * (kind == opcode)
        position += 9 + length
    return found


def changed(path: Path, position: int, new: bytes) -> Path:
    content = bytearray(path.read_bytes())
    content[position : position + len(new)] = new
    path.write_bytes(content)
    return path


def rows(path: Path) -> dict[str, list[tuple[int, float]]]:
    return rows_of(list(read_columns(path, SIGNALS)))


def rows_of(blocks: list[Block]) -> dict[str, list[tuple[int, float]]]:
    found: dict[str, list[tuple[int, float]]] = {}
    for block in blocks:
        for topic, columns in block.items():
            for field, column in columns.values.items():
                found.setdefault(f"{topic}.{field}", []).extend(
                    zip(columns.received.tolist(), column.tolist(), strict=True)
                )
    return found


def defined(path: Path, text: str) -> Path:
    """One message of zeros."""
    from mcap.writer import CompressionType, Writer

    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE, enable_crcs=False)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        writer.add_message(writer.register_channel("/a", "cdr", schema), T0, b"\0\1\0\0" + bytes(64), T0)
        writer.finish()
    return path


def traced(work: Callable[[], Any]) -> tuple[int, Any]:
    """Bytes of memory at most, and what came out."""
    tracemalloc.start()
    try:
        result = work()
        return tracemalloc.get_traced_memory()[1], result
    finally:
        tracemalloc.stop()
