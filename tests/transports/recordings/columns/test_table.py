"""Rows are found in the pages of a SQLite file as SQLite itself finds them."""

from __future__ import annotations

import random
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.columns.pieces import DamageError
from robophm.transports.recordings.columns.table import Pages, Table, find_rows

from ...conftest import SIGNALS
from ..made import T0

TABLE = (
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB)"
)


def database(path: Path, page: int, rows: list[tuple[int, int, Any]], table: str = TABLE) -> int:
    """A table of these rows; where its tree begins."""
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA page_size = {page}")
    connection.execute(table)
    connection.execute("CREATE TABLE other(text)")
    connection.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", rows)
    connection.execute("DELETE FROM messages WHERE id % 17 = 3")
    connection.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    connection.commit()
    (root,) = connection.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchone()
    connection.close()
    return int(root)


def random_rows(chance: random.Random, count: int, longest: int) -> list[tuple[int, int, bytes]]:
    times = [0, 1, -1, 127, -129, 40_000, -(2**23), 2**31, 2**40, -(2**47), 2**48, T0, -(2**63), 2**63 - 1]
    topics = [0, 1, 2, 200, 70_000, 2**40]
    return [
        (chance.choice(topics), chance.choice([*times, T0 + chance.randrange(10**9)]), chance.randbytes(size))
        for size in (chance.randint(0, longest) for _ in range(count))
    ]


@pytest.mark.parametrize("page", [512, 1024, 4096, 65536])
@pytest.mark.parametrize("count", [0, 1, 30, 3000])
def test_rows_are_those_that_sqlite_selects(page: int, count: int, tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    root = database(path, page, random_rows(random.Random(page + count), count, min(300, page - 90)))
    table, found = table_of(np.fromfile(path, np.uint8), root)
    with closing(sqlite3.connect(path)) as connection, connection:
        expected = connection.execute("SELECT id, topic_id, timestamp, data FROM messages ORDER BY id").fetchall()
    connection.close()
    assert found == expected
    assert not table.lost


def table_of(content: Bytes, root: int, expected: int | None = None) -> tuple[Table, list[tuple[int, int, int, bytes]]]:
    """What is found, and its rows as SQLite would select them."""
    pages = Pages(content)
    table = find_rows(pages, root, expected)
    used = np.zeros(pages.count + 1, np.bool_)
    found = []
    for number, topic, time, start, end, spill in zip(*(column.tolist() for column in table.rows), strict=True):
        data = content[start:end].copy()
        if spill:
            data = np.empty(end - start, np.uint8)
            pages.fill(data, start, spill, used)
        found.append((number, topic, time, data.tobytes()))
    return table, found


@pytest.mark.parametrize("page", [512, 1024, 4096])
def test_rows_on_several_pages_are_those_that_sqlite_selects(page: int, tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    chance = random.Random(page)
    rows = [
        (1, T0 + n, chance.randbytes(size)) for n, size in enumerate([*range(page - 60, page + 20), *[9 * page] * 5])
    ]
    root = database(path, page, rows)
    table, found = table_of(np.fromfile(path, np.uint8), root)
    with closing(sqlite3.connect(path)) as connection, connection:
        assert found == connection.execute("SELECT id, topic_id, timestamp, data FROM messages ORDER BY id").fetchall()
    connection.close()
    assert not table.lost


@pytest.mark.parametrize("row", [(1, 1.5, b"x"), (1, "noon", b"x"), (1, T0, "text"), (1, T0, None), ("a", T0, b"x")])
def test_rows_of_other_types_are_counted(row: Any, tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    table = TABLE.replace(" INTEGER NOT NULL", "")
    root = database(path, 4096, [(1, T0, b"good"), row], table)
    table_, found = table_of(np.fromfile(path, np.uint8), root)
    assert found == [(1, 1, T0, b"good")]
    assert table_.lost == {"rows that are no messages lost": 1}


@pytest.mark.full
@pytest.mark.parametrize("page", [512, 4096])
def test_whatever_byte_of_the_tree_is_damaged_the_rows_of_sound_leaves_are_found(page: int, tmp_path: Path) -> None:
    """Of an inner page that is damaged nothing is lost: the leaves are there. No row is made up, nor comes twice."""
    path = tmp_path / "x.db3"
    root = database(path, page, [(1, T0 + n, n.to_bytes(4, "big") * 10) for n in range(3000)])
    content = np.fromfile(path, np.uint8)
    _, whole = table_of(content, root)
    inner = np.flatnonzero(content[::page] == 5)
    assert len(inner)
    chance = random.Random(page)
    lost = 0
    for _ in range(200):
        damaged = content.copy()
        at = int(chance.choice(inner)) * page + chance.choice([chance.randrange(12), chance.randrange(page)])
        damaged[at] ^= 1 << chance.randrange(8)
        table, found = table_of(damaged, root, len(whole))
        assert found == whole
        lost += bool(table.lost)
    assert lost > 20


def test_pages_that_are_free_hold_no_rows(tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    root = database(path, 512, [(1, T0 + n, bytes(40)) for n in range(3000)])
    with closing(sqlite3.connect(path, isolation_level=None)) as connection, connection:
        connection.execute("DELETE FROM messages WHERE id > 1500")
        connection.execute("DROP INDEX timestamp_idx")
        assert connection.execute("PRAGMA freelist_count").fetchone()[0] > 100
        left = connection.execute("SELECT count(*) FROM messages").fetchone()[0]
    connection.close()
    content = np.fromfile(path, np.uint8)
    content[(root - 1) * 512 + 11] ^= 1  # another page in the place of the last: looked for beside the tree
    _, found = table_of(content, root)
    assert len(found) == len({number for number, *_ in found}) <= left


def test_both_ways_to_read_a_database_agree(
    recorded: dict[str, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    quick = list(read_columns(recorded[".db3"], SIGNALS))

    def refused(*_: Any) -> Any:
        raise DamageError

    monkeypatch.setattr("robophm.transports.recordings.columns.db3.Db3File._root", refused)
    slow = list(read_columns(recorded[".db3"], SIGNALS))
    for topic in {signal.partition(".")[0] for signal in SIGNALS}:
        one, other = ([block[topic] for block in blocks if topic in block] for blocks in (quick, slow))
        for name in one[0].values:
            np.testing.assert_array_equal(
                np.concatenate([columns.values[name] for columns in one]),
                np.concatenate([columns.values[name] for columns in other]),
            )
