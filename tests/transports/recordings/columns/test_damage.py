"""Bags and databases that are bad: what is whole is read, what is lost is said, and nothing hangs."""

from __future__ import annotations

import random
import sqlite3
import struct
import time
from collections import Counter
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.columns.chunked import ChunkedFile
from robophm.transports.recordings.columns.drive import opened
from robophm.transports.recordings.opening import open_source
from robophm.transports.synthetic import SyntheticOta

from ...conftest import SIGNALS
from ..made import rewrite, rewrite_mcap
from .damage import attempt, changed, records, rows, rows_of, traced
from .fuzz.shapes import bag_records


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


@pytest.mark.full
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


@pytest.fixture(scope="module")
def hour(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Recordings of some megabytes."""
    drive, folder = SyntheticOta(seed=5, duration=2400 * SECOND), tmp_path_factory.mktemp("hour")
    return {suffix: drive.record(folder / f"x{suffix}") for suffix in (".bag", ".mcap")}


@pytest.mark.full
@pytest.mark.parametrize("name", ["ZSTD.mcap", "LZ4.mcap", "LZ4.bag", "BZ2.bag"])
def test_a_chunk_whose_end_is_missing_is_unpacked_as_far_as_it_goes(
    name: str, hour: dict[str, Path], tmp_path: Path
) -> None:
    """One chunk alone, so that nothing of the file is read that is not of it."""
    from mcap.writer import CompressionType

    compression, suffix = name.split(".")
    path = tmp_path / name
    if suffix == "mcap":
        rewrite_mcap(hour[".mcap"], path, compression=CompressionType[compression], chunk_size=1 << 30)
    else:
        rewrite(hour[".bag"], path, compression, 1 << 30)
    signals = ("/ota/battery.voltage", "/ota/power/temperature.temperature")
    whole, content = rows_of(list(read_columns(path, signals))), path.read_bytes()
    with ExitStack() as stack:
        (file,) = opened([path], Counter(), stack)
        assert isinstance(file, ChunkedFile)
        (chunk,) = file.placed(file.chunks, frozenset(one.id for one in file.connections))
        begin, size = chunk.start, chunk.end - chunk.start
    counts = []
    for kept in (0.6, 0.75, 0.95):
        path.write_bytes(content[: begin + int(size * kept)])
        result = attempt(path, *signals)
        assert not isinstance(result, SourceError)
        blocks, notes = result
        found = rows_of(blocks)
        for signal, some in found.items():
            assert some == whole[signal][: len(some)]
        counts.append(sum(map(len, found.values())))
        assert any("cut or damaged" in note and "lost" in note for note in notes)
    assert 0 < counts[0] <= counts[1] <= counts[2] < sum(map(len, whole.values()))
    assert counts[0] < counts[2] or compression == "BZ2"  # of which a block has 900 kB, of what is there after runs


def test_one_bit_of_an_index_of_a_database_loses_no_row(recorded: dict[str, Path], tmp_path: Path) -> None:
    """Pages of the index and inner ones of the table: every row comes, whatever SQLite makes of it."""
    path = tmp_path / "x.db3"
    path.write_bytes((recorded[".db3"] / "drive.db3").read_bytes())
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("PRAGMA page_size = 512")
        database.execute("VACUUM")
    whole, content = rows(path), path.read_bytes()
    size = int.from_bytes(content[16:18], "big")
    with closing(sqlite3.connect(path)) as database:
        (root,) = database.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchone()
        (count,) = database.execute("SELECT count(*) FROM messages NOT INDEXED").fetchone()
    pages = [at for at in range(size, len(content), size) if content[at] in (2, 10) or at == (root - 1) * size]
    assert len(pages) >= 9
    chance = random.Random(1)
    hidden = 0
    for number in range(216):
        damaged = bytearray(content)
        at = pages[number % len(pages)] + chance.choice([chance.randrange(12), chance.randrange(size)])
        damaged[at] ^= 1 << chance.randrange(8)
        path.write_bytes(damaged)
        assert rows(path) == whole, at
        with closing(sqlite3.connect(path)) as database:
            try:
                query = "SELECT count(*) FROM (SELECT * FROM messages ORDER BY timestamp)"
                hidden += database.execute(query).fetchone()[0] < count
            except sqlite3.DatabaseError:
                hidden += 1
    assert hidden > 20


@pytest.mark.parametrize("at", [0, 16, None])
def test_a_database_whose_first_page_is_damaged_says_so(
    at: int | None, recorded: dict[str, Path], tmp_path: Path
) -> None:
    content = bytearray((recorded[".db3"] / "drive.db3").read_bytes())
    if at is None:
        content[:4096] = bytes(4096)
    else:
        content[at] ^= 0x55
    path = tmp_path / "x.db3"
    path.write_bytes(content)
    with pytest.raises(SourceError, match="the first page, which says where its tables are, is damaged"):
        read_columns(path, SIGNALS)


def test_a_database_without_definitions_or_topics_says_so(recorded: dict[str, Path], tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    content = bytearray((recorded[".db3"] / "drive.db3").read_bytes())
    path.write_bytes(content)
    whole = rows(path)
    with closing(sqlite3.connect(path)) as database, database:
        (root,) = database.execute("SELECT rootpage FROM sqlite_master WHERE name = 'message_definitions'").fetchone()
        content[(root - 1) * 4096] = 99
        database.execute("DELETE FROM topics")
    database.close()
    said = attempt(path)
    assert not isinstance(said, SourceError)
    assert said[1] == {"x.db3: all messages lost: its table of topics names none": 1}
    path.write_bytes(content)
    found = attempt(path, *SIGNALS)
    assert not isinstance(found, SourceError)
    assert rows_of(found[0]) == whole  # all of types that are well known
    assert any("definitions of message types are lost" in note for note in found[1])


@pytest.mark.parametrize("suffix", [".bag", ".mcap"])
def test_an_index_with_a_time_that_its_chunk_does_not_have_is_not_believed(
    suffix: str, recorded: dict[str, Path], tmp_path: Path
) -> None:
    """Another valid number, a day later: when topics begin and end, their messages say then."""
    content = bytearray(recorded[suffix].read_bytes())
    with open_source(recorded[suffix]) as source:
        expected = source.topics()
    if suffix == ".bag":
        found = bag_records(bytes(content), 13, len(content))
        place = next(data for fields, _, data, _ in found if content[fields[b"op"][0]] == 4)
        form, step = "<I", 86400
    else:
        place, form, step = records(bytes(content), 7)[0] + 15, "<Q", 86400 * SECOND
    (time,) = struct.unpack_from(form, content, place)
    struct.pack_into(form, content, place, time + step)
    path = tmp_path / f"x{suffix}"
    path.write_bytes(content)
    with open_source(path) as source:
        assert source.topics() == expected
