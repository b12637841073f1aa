"""Bad files: what is whole is read, what is lost is said, and nothing hangs or is read outside the file."""

from __future__ import annotations

import math
import sqlite3
import struct
import time
import tracemalloc
from collections import Counter
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
import zstandard

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import Block, read_columns
from robophm.transports.recordings.columns.mcap import CHUNK, CHUNK_INDEX, MESSAGE_INDEX

from ...conftest import SIGNALS
from ..test_recording import T0, TEMPERATURE, rewrite, rewrite_mcap, temperature

Write = Callable[..., Path]
SIGNAL = "/t.temperature"


@pytest.fixture
def numbered(tmp_path: Path, write_messages: Write) -> Path:
    """A hundred temperatures, 0 to 99."""
    messages = [("/t", TEMPERATURE, T0 + n * SECOND, temperature(T0 + n * SECOND, float(n))) for n in range(100)]
    return write_messages(tmp_path / "numbered.mcap", messages)


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


# MCAP


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


# Bags and databases


@pytest.mark.parametrize("compression", ["", "LZ4", "BZ2"])
def test_bags_without_index_or_end(compression: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    path = rewrite(recorded[".bag"], tmp_path / "x.bag", compression) if compression else recorded[".bag"]
    content = path.read_bytes()
    whole = rows(path)
    begin = content.index(b"index_pos=") + len("index_pos=")
    (end,) = struct.unpack_from("<Q", content, begin)
    unclosed = tmp_path / "unclosed.bag"
    unclosed.write_bytes(content[:begin] + bytes(8) + content[begin + 8 : end])
    assert rows(unclosed) == whole
    unclosed.write_bytes(content[:end])
    assert rows(unclosed) == whole
    for size in (end - 100, end // 2, end // 5):
        unclosed.write_bytes(content[:size])
        result = attempt(unclosed, *SIGNALS)
        if isinstance(result, SourceError):
            assert str(unclosed) in str(result)  # nothing of it is there yet
            continue
        blocks, notes = result
        assert any("lost" in note for note in notes)
        for signal, some in rows_of(blocks).items():
            assert some == whole[signal][: len(some)]


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


def test_databases_that_are_cut_say_so(recorded: dict[str, Path], tmp_path: Path) -> None:
    source = recorded[".db3"] / "drive.db3"
    content = source.read_bytes()
    whole = rows(source)
    path = tmp_path / "cut.db3"
    for kept in (0.2, 0.5, 0.9, 0.99):
        path.write_bytes(content[: int(len(content) * kept)])
        result = attempt(path, *SIGNALS)
        if isinstance(result, SourceError):
            assert str(path) in str(result)
            continue
        blocks, notes = result
        for signal, some in rows_of(blocks).items():
            assert set(some) <= set(whole[signal])
        assert any("lost" in note and "cut short" in note for note in notes)


def test_a_database_cut_within_its_last_page_is_read_without_it(recorded: dict[str, Path], tmp_path: Path) -> None:
    """SQLite would take what is missing of the page for zeros, and messages in it for whole.

    The last page of messages, that is: some versions of SQLite have one of the index behind it.
    """
    content = (recorded[".db3"] / "drive.db3").read_bytes()
    path = tmp_path / "cut.db3"
    path.write_bytes(content)
    whole = rows(path)
    size = int.from_bytes(content[16:18], "big")
    pages = [content[at : at + size] for at in range(0, len(content), size)]
    leaves = [i for i, page in enumerate(pages) if page[0] == 0x0D and int.from_bytes(page[3:5], "big") >= 5]
    for missing in (1, 21, 511):
        path.write_bytes(content[: (leaves[-1] + 1) * size - missing])
        found = attempt(path, *SIGNALS)
        assert not isinstance(found, SourceError)
        read = rows_of(found[0])
        assert all(set(some) <= set(whole[signal]) for signal, some in read.items())
        assert sum(map(len, whole.values())) * 0.8 < sum(map(len, read.values())) < sum(map(len, whole.values()))
        assert any("cut short" in note for note in found[1])
        assert any("messages that its index counts and its table lacks lost" in note for note in found[1])


def test_rows_of_any_type(recorded: dict[str, Path], tmp_path: Path) -> None:
    import shutil
    import sqlite3

    path = tmp_path / "odd.db3"
    shutil.copy(recorded[".db3"] / "drive.db3", path)
    whole = rows(path)
    with closing(sqlite3.connect(path)) as database, database:
        for id_, column, value in ((3, "data", "text"), (9, "timestamp", "noon"), (20, "data", 1.5)):
            database.execute(f"UPDATE messages SET {column} = ? WHERE id = ?", (value, id_))
    database.close()
    columns = read_columns(path, SIGNALS)
    found = rows_of(list(columns))
    assert sum(map(len, found.values())) < sum(map(len, whole.values()))
    assert all(set(some) <= set(whole[signal]) for signal, some in found.items())


# Definitions


@pytest.mark.parametrize(
    "text",
    [
        "a_msgs/A again\nfloat64 x",
        "a_msgs/Missing m\nfloat64 x",
        "float64 (x",
        "string[900000000] s\nfloat64 x",
        "B[900000000] b\nfloat64 x\n" + "=" * 80 + "\nMSG: a_msgs/B\nfloat64 x",
        "B b\nfloat64 x\n" + "=" * 80 + "\nMSG: a_msgs/B\nA a\n" + "=" * 80 + "\nMSG: a_msgs/A\nB[] b",
    ],
)
def test_definitions_that_cannot_be_followed(text: str, tmp_path: Path) -> None:
    from mcap.writer import Writer

    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        writer.add_message(writer.register_channel("/a", "cdr", schema), T0, b"\0\1\0\0" + bytes(8), T0)
        writer.add_message(writer.register_channel("/j", "json", schema), T0, b"{}", T0)
        writer.finish()
    with pytest.raises(SourceError, match="definition of its type 'a_msgs/msg/A' is missing or damaged"):
        read_columns(path, ["/a.x"])
    with pytest.raises(SourceError, match="'/j' is encoded as 'json'; expected cdr or ros1"):
        read_columns(path, ["/j.x"])


def test_headers_whose_time_is_no_number(tmp_path: Path) -> None:
    """A Header of somebody's own, of floats: receipt is the time."""
    from mcap.writer import Writer

    text = "std_msgs/Header header\nfloat64 x\n" + "=" * 80 + "\nMSG: std_msgs/Header\nstd_msgs/Clock stamp\n"
    text += "=" * 80 + "\nMSG: std_msgs/Clock\nfloat64 sec\nfloat32 nanosec"
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        channel = writer.register_channel("/a", "cdr", schema)
        for number, sec in enumerate([math.nan, math.inf, 1e300, T0 / SECOND]):
            raw = b"\0\1\0\0" + struct.pack("<dfxxxxd", sec, 0.0, number)
            writer.add_message(channel, T0 + number, raw, T0)
        writer.finish()
    columns = read_columns(path, ["/a.x"])
    (block,) = columns
    assert block["/a"].values["x"].tolist() == [0, 1, 2, 3]
    assert block["/a"].times.tolist() == [T0, T0 + 1, T0 + 2, T0]
    assert columns.notes["receipt time used for /a"] == 3


def test_a_nan_that_signals_is_a_nan(tmp_path: Path) -> None:
    path = defined(tmp_path / "a.mcap", "float32 x\nfloat32[15] rest")
    content = path.read_bytes()
    at = content.index(b"\0\1\0\0" + bytes(64)) + 4
    path.write_bytes(content[:at] + struct.pack("<I", 0x7FA00000) + content[at + 4 :])
    (block,) = read_columns(path, ["/a.x"])
    assert math.isnan(block["/a"].values["x"][0])


def test_numbers_too_large_to_count_with(tmp_path: Path) -> None:
    """Arrays and indices that no message can hold: nothing is found, and nothing else is found instead."""
    from mcap.writer import Writer

    path = tmp_path / "a.mcap"
    text = "B[] b\nfloat64[] y\n" + "=" * 80 + "\nMSG: a_msgs/B\nfloat64[4000000000] x"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        schema = writer.register_schema("a_msgs/msg/A", "ros2msg", text.encode())
        channel = writer.register_channel("/a", "cdr", schema)
        writer.add_message(channel, T0, b"\0\1\0\0" + bytes(8), T0)
        writer.add_message(channel, T0 + 1, b"\0\1\0\0" + b"\xff" * 8 + bytes(64), T0)
        writer.finish()
    columns = read_columns(path, ["/a.y[0]", f"/a.y[{10**30}]"])
    (block,) = columns
    assert [absent.tolist() for absent in block["/a"].absent.values()] == [[True], [True]]
    assert columns.notes["unreadable message on /a"] == 1


# Structure that is damaged in one place, or made to cost


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


@pytest.mark.parametrize("field", [b"conn_count=", b"chunk_count=", b"index_pos="])
def test_what_a_bag_says_of_its_index_is_not_believed(field: bytes, recorded: dict[str, Path], tmp_path: Path) -> None:
    content = recorded[".bag"].read_bytes()
    at = content.index(field) + len(field)
    for lie in (0, 1, 2, 0x7FFFFFFF):
        path = tmp_path / f"{lie}.bag"
        path.write_bytes(content[:at] + struct.pack("<I", lie) + content[at + 4 :])
        assert rows(path) == rows(recorded[".bag"])


def test_a_bag_whose_first_record_is_damaged(recorded: dict[str, Path], tmp_path: Path) -> None:
    path = tmp_path / "x.bag"
    path.write_bytes(recorded[".bag"].read_bytes())
    assert rows(changed(path, 13, b"\xff" * 8)) == rows(recorded[".bag"])


@pytest.mark.parametrize("fields", ["L{0} a\nL{0} b", "L{0}[] a\nL{0}[] b", "L{0}[2] a", "L{0}[900] a"])
def test_definitions_that_double(fields: str, tmp_path: Path) -> None:
    """Forty types, each twice in the one before: a trillion fields in a few lines."""
    parts = [fields.format(level) + "\n" + "=" * 80 + f"\nMSG: a_msgs/L{level}" for level in range(40)]
    begun = time.process_time()
    with pytest.raises(SourceError, match="definition of its type 'a_msgs/msg/A' is missing or damaged"):
        read_columns(defined(tmp_path / "a.mcap", "\n".join(["float64 y", *parts, "float64 x"])), ["/a.y"])
    text = "".join(f"float64 y{n}\n" for n in range(20_000))
    with pytest.raises(SourceError, match="definition of its type 'a_msgs/msg/A' is missing or damaged"):
        read_columns(defined(tmp_path / "b.mcap", text), ["/a.y1"])
    assert time.process_time() - begun < 5


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


@pytest.mark.parametrize("table", ["topics", "messages"])
def test_tables_that_never_end(table: str, recorded: dict[str, Path], tmp_path: Path) -> None:
    """A view that counts for ever in the place of a table, and rows of a gigabyte that take no byte of the file."""
    path = tmp_path / "x.db3"
    path.write_bytes((recorded[".db3"] / "drive.db3").read_bytes())
    with closing(sqlite3.connect(path)) as database, database:
        database.execute(f"ALTER TABLE {table} RENAME TO sound")
        endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT s.* FROM n, sound s"
        database.execute(f"CREATE VIEW {table} AS {endless}")
    database.close()
    begun = time.process_time()
    peak, result = traced(lambda: attempt(path, *SIGNALS))
    if isinstance(result, SourceError):
        assert "interrupted" in str(result)
    else:
        assert any("interrupted" in note for note in result[1])
    assert time.process_time() - begun < 5 * 4  # tracing slows it down
    assert peak < 512 << 20


def traced(work: Callable[[], Any]) -> tuple[int, Any]:
    """Bytes of memory at most, and what came out."""
    tracemalloc.start()
    try:
        result = work()
        return tracemalloc.get_traced_memory()[1], result
    finally:
        tracemalloc.stop()


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
