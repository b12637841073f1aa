"""Two gigabytes of nothing in a file take neither memory nor time."""

from __future__ import annotations

import os
import struct
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.mcap_records import CHUNK

from ...conftest import SIGNALS
from ..made import T0
from .damage import attempt, rows, rows_of, traced

PADDING = 2 << 30


def padded(path: Path, before: bytes, after: bytes = b"") -> Path:
    """Zeros that take no space on the disk."""
    with path.open("wb") as file:
        file.write(before)
        file.seek(len(before) + PADDING)
        file.write(after)
        file.truncate()
    return path


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap"])
def test_two_gigabytes_behind_the_end(suffix: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    sound = recorded[suffix] / "drive.db3" if suffix == ".db3" else recorded[suffix]
    expected = rows(sound)
    path = padded(tmp_path / f"x{suffix}", sound.read_bytes())
    assert cheaply(path) == expected


@pytest.mark.full
@pytest.mark.parametrize("opcode", [9, 0x80, CHUNK])
def test_two_gigabytes_in_a_record_of_mcap(opcode: int, recorded: dict[str, Path], tmp_path: Path) -> None:
    """An attachment, a record of a kind of its own or a chunk: before the data, where no offset holds any more."""
    content = recorded[".mcap"].read_bytes()
    begin = 8 + 9 + struct.unpack_from("<Q", content, 9)[0]
    head = struct.pack("<QQQIIQ", T0, T0, PADDING, 0, 0, PADDING) if opcode == CHUNK else b""
    before = content[:begin] + struct.pack("<BQ", opcode, len(head) + PADDING) + head
    path = padded(tmp_path / "x.mcap", before, content[begin:])
    assert cheaply(path) == rows(recorded[".mcap"])


@pytest.mark.full
@pytest.mark.parametrize("where", ["chunk", *(pytest.param(one, marks=pytest.mark.full) for one in ("header", "data"))])
def test_two_gigabytes_in_a_record_of_a_bag(where: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    content = recorded[".bag"].read_bytes()
    begin = 13 + 4096
    head = b"".join(struct.pack("<I", len(field)) + field for field in (b"op=\5", b"compression=none"))
    size = struct.pack("<I", 9) + b"size=" + struct.pack("<I", PADDING)
    record = {
        "header": struct.pack("<I", PADDING - 4),
        "data": struct.pack("<I", 8) + struct.pack("<I", 4) + b"op=\x20" + struct.pack("<I", PADDING),
        "chunk": struct.pack("<I", len(head + size)) + head + size + struct.pack("<I", PADDING),
    }[where]
    path = padded(tmp_path / "x.bag", content[:begin] + record, content[begin:])
    found = cheaply(path)
    if where != "header":
        assert found == rows(recorded[".bag"])


def cheaply(path: Path) -> dict[str, list[tuple[int, float]]]:
    """What is read, in five seconds and little memory; what is odd is said.

    The system's own time is left out: where its memory is full of files, finding pages for two gigabytes takes seconds.
    """
    begun = os.times().user
    peak, result = traced(lambda: attempt(path, *SIGNALS))
    assert os.times().user - begun < 5
    assert peak < 64 << 20
    if isinstance(result, SourceError):
        assert str(path) in str(result)
        return {}
    return rows_of(result[0])
