"""What small databases have in common, page by page, beside what SQLite itself says of them."""

from __future__ import annotations

import sqlite3
from collections import Counter
from contextlib import closing
from pathlib import Path

import pytest

from robophm.transports.recordings.columns.db3 import Db3File
from robophm.transports.recordings.columns.pieces import DamageError
from robophm.transports.recordings.columns.small_tables import entries_of, is_whole, parts_alike

ROWS = 300


def database(path: Path, page: int = 4096, *, rows: int = ROWS, definition: str = "float64 value\n" * 500) -> Path:
    """A recording as rosbag2 makes it."""
    with closing(sqlite3.connect(path)) as base:
        base.execute(f"PRAGMA page_size = {page}")
        base.execute(
            "CREATE TABLE topics (id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
            "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)"
        )
        base.execute(
            "CREATE TABLE message_definitions (id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, "
            "encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)"
        )
        base.execute(
            "CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, "
            "data BLOB NOT NULL)"
        )
        base.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
        base.execute("INSERT INTO topics VALUES (1, '/a', 'own/msg/Value', 'cdr', '')")
        base.execute("INSERT INTO message_definitions VALUES (1, 'own/msg/Value', 'ros2msg', ?, '')", (definition,))
        times = [(1_700_000_000_000_000_000 + 1000 * row, bytes(row % 90)) for row in range(rows)]
        base.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)", times)
        base.commit()
    return path


def change(path: Path, statement: str) -> None:
    with closing(sqlite3.connect(path)) as base:
        base.execute(statement)
        base.commit()


def opened(path: Path) -> tuple[list[str], int, Counter[str]]:
    notes: Counter[str] = Counter()
    file = Db3File(path, notes)
    told = file.told()
    for piece in file.pieces([1], 0, 2**62):
        piece.load()
    file.close()
    return [one.topic for one in file.connections], sum(count for count, _ in told.values()), notes


@pytest.mark.parametrize("page", [512, 1024, 4096])
@pytest.mark.parametrize("rows", [0, 1, 40, 3000])
def test_entries_are_those_that_sqlite_counts(tmp_path: Path, page: int, rows: int) -> None:
    path = database(tmp_path / "a.db3", page, rows=rows)
    with closing(sqlite3.connect(path)) as base:
        (counted,) = base.execute("SELECT count(*) FROM messages INDEXED BY timestamp_idx").fetchone()
        (root,) = base.execute("SELECT rootpage FROM sqlite_master WHERE name = 'timestamp_idx'").fetchone()
        (table,) = base.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchone()
    content = memoryview(path.read_bytes())
    assert entries_of(content, root) == counted == rows
    assert is_whole(content)
    assert not is_whole(content[:-page])
    with pytest.raises(DamageError):
        entries_of(content, table)


def test_definitions_that_go_on_on_other_pages_are_among_what_is_alike(tmp_path: Path) -> None:
    path = database(tmp_path / "a.db3")
    with closing(sqlite3.connect(path)) as base:
        roots = [root for (root,) in base.execute("SELECT rootpage FROM sqlite_master WHERE type = 'table'")][:2]
    content = path.read_bytes()
    covered = bytearray(len(content))
    for at, part in parts_alike(memoryview(content), roots):
        assert content[at : at + len(part)] == part
        covered[at : at + len(part)] = b"\1" * len(part)
    at = content.index(b"float64 value")
    while at >= 0:
        assert all(covered[at : at + 13])
        at = content.find(b"float64 value", at + 1)


@pytest.mark.parametrize(
    ("statement", "topics", "count"),
    [
        ("UPDATE topics SET name = '/b'", ["/b"], ROWS),
        ("INSERT INTO topics VALUES (2, '/b', 'own/msg/Value', 'cdr', '')", ["/a", "/b"], ROWS),
        ("DELETE FROM messages WHERE id > 100", ["/a"], 100),
        ("DROP INDEX timestamp_idx", ["/a"], ROWS),
    ],
)
def test_a_file_with_other_tables_is_not_taken_for_the_one_before(
    tmp_path: Path, statement: str, topics: list[str], count: int
) -> None:
    first, second = database(tmp_path / "first.db3"), database(tmp_path / "second.db3")
    change(second, statement)
    for path, expected in ((first, (["/a"], ROWS)), (second, (topics, count)), (first, (["/a"], ROWS))):
        assert opened(path) == (*expected, Counter())


def test_rows_that_are_lost_are_told_of_as_in_a_file_alone(tmp_path: Path) -> None:
    first, second = database(tmp_path / "first.db3"), database(tmp_path / "second.db3")
    with closing(sqlite3.connect(second)) as base:
        (root,) = base.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchone()
    content = bytearray(second.read_bytes())
    leaf = int.from_bytes(content[(root - 1) * 4096 + 8 :][:4], "big")  # the last page of the table
    rows = int.from_bytes(content[(leaf - 1) * 4096 + 3 :][:2], "big")
    content[(leaf - 1) * 4096 + 3] = content[(leaf - 1) * 4096 + 4] = 0
    second.write_bytes(content)
    assert opened(first) == (["/a"], ROWS, Counter())
    topics, count, notes = opened(second)
    assert (topics, count) == (["/a"], ROWS - rows)
    assert notes == {"second.db3: messages that its index counts and its table lacks lost": rows}
