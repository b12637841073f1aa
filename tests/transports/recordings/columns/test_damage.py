"""Bags and databases that are bad: what is whole is read, what is lost is said, and nothing hangs."""

from __future__ import annotations

import sqlite3
import struct
import time
from contextlib import closing
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns import read_columns

from ...conftest import SIGNALS
from ..made import rewrite
from .damage import attempt, changed, rows, rows_of, traced


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
