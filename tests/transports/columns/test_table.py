"""Rows are found in the pages of a SQLite file as SQLite itself finds them."""

from __future__ import annotations

import random
import sqlite3
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.transports.columns import read_columns
from robophm.transports.columns.pieces import DamageError
from robophm.transports.columns.table import find_rows

from ..conftest import SIGNALS
from ..test_recording import T0

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
    content = np.fromfile(path, np.uint8)
    with sqlite3.connect(path) as connection:
        for wanted in ([1], [0, 200, 70_000], [2, 2**40], [9]):
            marks = ", ".join("?" * len(wanted))
            query = f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({marks}) ORDER BY id"
            expected = connection.execute(query, wanted).fetchall()
            rows = find_rows(content, root, wanted)
            found = [
                (topic, time, content[start:end].tobytes())
                for topic, time, start, end in zip(*(column.tolist() for column in rows), strict=True)
            ]
            assert found == expected
    connection.close()


def test_rows_on_several_pages_are_left_to_sqlite_where_they_are_wanted(tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    rows = random_rows(random.Random(1), 200, 300)
    rows += [(5, T0, bytes(10_000))] * 3
    root = database(path, 1024, rows)
    content = np.fromfile(path, np.uint8)
    assert len(find_rows(content, root, [1]).times) > 10
    with pytest.raises(DamageError, match="on other pages"):
        find_rows(content, root, [1, 5])


@pytest.mark.parametrize("row", [(1, 1.5, b"x"), (1, "noon", b"x"), (1, T0, "text"), (1, T0, None), ("a", T0, b"x")])
def test_rows_of_other_types_are_left_to_sqlite(row: Any, tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    table = TABLE.replace(" INTEGER NOT NULL", "")
    root = database(path, 4096, [(1, T0, b"good"), row], table)
    with pytest.raises(DamageError):
        find_rows(np.fromfile(path, np.uint8), root, [1])


def test_both_ways_to_read_a_database_agree(
    recorded: dict[str, Path], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    found: list[Any] = []

    def watched(*arguments: Any) -> Any:
        found.append(find_rows(*arguments))
        return found[-1]

    monkeypatch.setattr("robophm.transports.columns.db3.find_rows", watched)
    quick = list(read_columns(recorded[".db3"], SIGNALS))
    assert len(found[0].times) == 90

    def refused(*_: Any) -> Any:
        raise DamageError

    monkeypatch.setattr("robophm.transports.columns.db3.find_rows", refused)
    slow = list(read_columns(recorded[".db3"], SIGNALS))
    for topic in {signal.partition(".")[0] for signal in SIGNALS}:
        one, other = ([block[topic] for block in blocks if topic in block] for blocks in (quick, slow))
        for name in one[0].values:
            np.testing.assert_array_equal(
                np.concatenate([columns.values[name] for columns in one]),
                np.concatenate([columns.values[name] for columns in other]),
            )
