"""Bad MCAP: what is whole is read, what is lost is said, and nothing hangs or is read outside the file."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import pytest
import zstandard

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.columns.mcap_records import CHUNK, CHUNK_INDEX, MESSAGE_INDEX

from ..made import T0, TEMPERATURE, rewrite_mcap, temperature
from .damage import SIGNAL, Write, attempt, changed, in_chunks, records, rows, traced, values


@pytest.fixture
def numbered(tmp_path: Path, write_messages: Write) -> Path:
    """A hundred temperatures, 0 to 99."""
    messages = [("/t", TEMPERATURE, T0 + n * SECOND, temperature(T0 + n * SECOND, float(n))) for n in range(100)]
    return write_messages(tmp_path / "numbered.mcap", messages)


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_a_chunk_that_is_not_what_was_written_is_lost_alone(compression: str, numbered: Path) -> None:
    from mcap.writer import CompressionType

    path = in_chunks(numbered, compression=CompressionType[compression])
    whole = values(list(read_columns(path, [SIGNAL])))
    assert whole == [float(n) for n in range(100)]
    chunks = records(path.read_bytes(), CHUNK)
    assert len(chunks) > 5
    changed(path, chunks[3] + 120, b"\x55\xaa\x55")
    columns = read_columns(path, [SIGNAL])
    left = values(list(columns))
    assert 80 < len(left) < 100
    assert set(left) < set(whole)
    assert columns.notes[f"{path.name}: messages of /t lost"] == 100 - len(left)
    said = [note for note in columns.notes if f"at byte {chunks[3]} lost" in note]
    assert len(said) == 1
    if compression == "NONE":
        assert "checksum" in said[0]


@pytest.mark.parametrize("opcode", [MESSAGE_INDEX, CHUNK_INDEX])
def test_indices_that_lie_are_not_believed(opcode: int, numbered: Path) -> None:
    """Every number of the indices of a chunk is made wrong in turn: no message is lost that is there to be found."""
    path = in_chunks(numbered)
    content = path.read_bytes()
    start = records(content, opcode)[2]
    (length,) = struct.unpack_from("<Q", content, start + 1)
    for position in range(start + 9, start + 9 + min(length, 50)):
        for lie in (0x00, 0x01, 0xFF):
            if content[position] == lie:
                continue
            path.write_bytes(content)
            found = values(list(read_columns(changed(path, position, bytes([lie])), [SIGNAL])))
            assert found == [float(n) for n in range(100)], (position - start, lie)


@pytest.mark.parametrize("options", [{}, {"repeat_channels": False}, {"repeat_schemas": False}])
@pytest.mark.parametrize("without", ["IndexType.NONE", "IndexType.MESSAGE", "IndexType.CHUNK"])
def test_without_an_index(options: dict[str, Any], without: str, numbered: Path) -> None:
    from mcap.writer import IndexType

    path = in_chunks(numbered, index_types=IndexType[without.partition(".")[2]], **options)
    assert values(list(read_columns(path, [SIGNAL]))) == [float(n) for n in range(100)]


@pytest.mark.parametrize("kept", [0.05, 0.3, 0.5, 0.77, 0.9, 0.97, 0.9999])
@pytest.mark.parametrize("compression", ["NONE", "ZSTD"])
def test_mcap_that_is_cut(kept: float, compression: str, numbered: Path) -> None:
    from mcap.writer import CompressionType

    path = in_chunks(numbered, compression=CompressionType[compression])
    content = path.read_bytes()
    size = int(len(content) * kept)
    starts = records(content, CHUNK)
    ends = [at + 9 + struct.unpack_from("<Q", content, at + 1)[0] for at in starts]
    path.write_bytes(content[:size])
    counts = [struct.unpack_from("<I", content, at + 11)[0] // 16 for at in records(content, MESSAGE_INDEX)]
    assert sum(counts) == 100
    result = attempt(path, SIGNAL)
    if isinstance(result, SourceError):
        assert "no topic '/t'" in str(result)
        assert size < ends[0]
        return
    blocks, notes = result
    found = values(blocks)
    assert found == [float(n) for n in range(len(found))]
    assert len(found) >= sum(count for count, end in zip(counts, ends, strict=True) if end <= size)
    if len(found) < 100:
        assert any("cut" in note and "lost" in note for note in notes)
    assert notes


def test_a_chunk_that_would_unpack_to_gigabytes(numbered: Path) -> None:
    from mcap.writer import CompressionType

    path = in_chunks(numbered, compression=CompressionType.ZSTD)
    start = records(path.read_bytes(), CHUNK)[0]
    columns = read_columns(changed(path, start + 9 + 16, struct.pack("<Q", 1 << 50)), [SIGNAL])
    assert 80 < len(values(list(columns))) < 100
    assert any(f"a chunk of {1 << 50} bytes" in note for note in columns.notes)


def test_a_message_twice_in_an_index(numbered: Path) -> None:
    path = in_chunks(numbered)
    content = path.read_bytes()
    start = records(content, MESSAGE_INDEX)[1] + 15
    changed(path, start + 16, content[start : start + 16])
    assert values(list(read_columns(path, [SIGNAL]))) == [float(n) for n in range(100)]


@pytest.mark.parametrize("checksums", [True, False])
def test_a_chunk_whose_length_lies_is_lost_alone(checksums: bool, numbered: Path) -> None:
    """The index says where the next one lies, be it believed or not."""
    path = in_chunks(numbered, enable_crcs=checksums)
    content = path.read_bytes()
    start = records(content, CHUNK)[3]
    for lie in (0, 20, 10**6, 2**63):
        path.write_bytes(content)
        columns = read_columns(changed(path, start + 1, struct.pack("<Q", lie)), [SIGNAL])
        left = values(list(columns))
        assert 80 < len(left) < 100
        assert left == sorted({*left})
        assert any("lost" in note for note in columns.notes)


@pytest.mark.parametrize("believed", [True, False])
def test_a_chunk_whose_length_spans_others_hides_none(believed: bool, numbered: Path) -> None:
    """What it holds is said by another number."""
    path = in_chunks(numbered)
    content = bytearray(path.read_bytes())
    chunks = records(content, CHUNK)
    struct.pack_into("<Q", content, chunks[3] + 1, 1500)
    if not believed:
        content[chunks[0]] = 7  # so that the index is not believed
    path.write_bytes(content)
    left = values(list(read_columns(path, [SIGNAL])))
    assert left[-80:] == [float(n) for n in range(20, 100)]


@pytest.mark.parametrize("opcode", [0, *(n for n in range(1, 20) if n != CHUNK), 128, 255])
def test_a_chunk_that_says_it_is_something_else_is_lost_alone(opcode: int, numbered: Path) -> None:
    path = in_chunks(numbered)
    whole = [float(n) for n in range(100)]
    columns = read_columns(changed(path, records(path.read_bytes(), CHUNK)[3], bytes([opcode])), [SIGNAL])
    left = values(list(columns))
    assert 80 < len(left) < 100
    assert left[:10] + left[-50:] == whole[:10] + whole[-50:]
    assert columns.notes


def test_a_record_whose_length_spans_chunks_hides_none(numbered: Path) -> None:
    """As where the index behind a chunk says that it is an unknown record of thousands of bytes."""
    path = in_chunks(numbered)
    content = path.read_bytes()
    chunks, indices = records(content, CHUNK), records(content, MESSAGE_INDEX)
    path.write_bytes(content)
    for opcode, end in ((63, chunks[-1] + 1), (63, len(content) - 50), (CHUNK_INDEX, chunks[5] + 3)):
        lying = bytearray(content)
        lying[chunks[2]] = 7  # so that the index is not believed
        struct.pack_into("<BQ", lying, indices[3], opcode, end - indices[3] - 9)
        path.write_bytes(lying)
        columns = read_columns(path, [SIGNAL])
        left = values(list(columns))
        assert 80 < len(left) < 100
        assert left[-50:] == [float(n) for n in range(50, 100)]


def test_definitions_in_chunks_are_better_than_a_damaged_summary(numbered: Path) -> None:
    path = in_chunks(numbered)
    content = path.read_bytes()
    at = content.rindex(b"float64 temperature")
    assert at > records(content, CHUNK)[-1]
    columns = read_columns(changed(path, at, b"float32 "), [SIGNAL])
    assert values(list(columns)) == [float(n) for n in range(100)]


def test_a_channel_that_only_a_damaged_summary_knows_spoils_nothing(numbered: Path) -> None:
    path = in_chunks(numbered)
    content = path.read_bytes()
    at = content.rindex(b"\2\0\0\0/t") - 4
    assert content[at : at + 4] == b"\1\0\1\0"  # channel and schema
    columns = read_columns(changed(path, at, bytes(4)), [SIGNAL])
    assert values(list(columns)) == [float(n) for n in range(100)]


def test_definitions_of_a_sound_summary_are_better_than_those_among_the_data(numbered: Path) -> None:
    path = rewrite_mcap(numbered, numbered.with_name("loose.mcap"), use_chunking=False)
    at = path.read_bytes().index(b"float64 temperature")
    columns = read_columns(changed(path, at, b"float32 "), [SIGNAL])
    assert values(list(columns)) == [float(n) for n in range(100)]


def test_an_index_that_is_cut_loses_no_message(recorded: dict[str, Path], tmp_path: Path) -> None:
    """Of the last chunk's index only the first record is there."""
    path = rewrite_mcap(recorded[".mcap"], tmp_path / "x.mcap", chunk_size=2000)
    content = path.read_bytes()
    whole = rows(path)
    indices = records(content, MESSAGE_INDEX)
    last = [at for at in indices if at > records(content, CHUNK)[-1]]
    assert len(last) > 1
    path.write_bytes(content[: last[1]])
    assert rows(path) == whole


def test_a_chunk_that_does_unpack_to_gigabytes(numbered: Path) -> None:
    """Thirty kilobytes of the file, and no lie."""
    path = in_chunks(numbered)
    content = path.read_bytes()
    size = 1 << 30
    packed = zstandard.ZstdCompressor().compressobj(size=size)
    zeros = b"".join([*(packed.compress(bytes(1 << 24)) for _ in range(size >> 24)), packed.flush()])
    head = struct.pack("<QQQI", T0, T0, size, 0) + struct.pack("<I", 4) + b"zstd" + struct.pack("<Q", len(zeros))
    begin = records(content, CHUNK)[0]
    chunk = struct.pack("<BQ", CHUNK, len(head) + len(zeros)) + head + zeros
    path.write_bytes(content[:begin] + chunk + content[begin:])
    peak, result = traced(lambda: attempt(path, SIGNAL))
    assert not isinstance(result, SourceError)
    assert values(result[0]) == [float(n) for n in range(100)]
    assert any(f"a chunk of {size} bytes" in note for note in result[1])
    assert peak < 64 << 20
