"""Stores and journals of every earlier version, written by that version itself, are gone on with."""

from __future__ import annotations

import gzip
import json
import sqlite3
import zlib
from collections import Counter
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.errors import SourceError, StoreError
from robophm.core.signal import CLOCK, HOUR, SECOND
from robophm.design.file import load
from robophm.health.ledger import Ledger
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.service_requests import ServiceRequest
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Progress
from robophm.transports.recordings.journal import JournalRecording

FORMATS = Path(__file__).parents[1] / "data" / "formats"
STORES = sorted(FORMATS.glob("*.db.gz"))
BEGIN = 1_795_000_020
"""When the two hours began that each store has [s]: 35, 36, 37 and 38 °C, every five seconds, half an hour each."""


def written(path: Path, begin: int, end: int) -> Path:
    rows = [f"{BEGIN + second},{35 + second // 1800}\n" for second in range(begin, end, 5)]
    path.write_text("time,/motor.temperature\n" + "".join(rows))
    return path


@pytest.fixture(params=STORES, ids=lambda path: path.name.partition(".")[0])
def kept(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / "past.db"
    path.write_bytes(gzip.decompress(request.param.read_bytes()))
    return path


def rows(path: Path, query: str) -> list[Any]:
    with closing(sqlite3.connect(path)) as base:
        return base.execute(query).fetchall()


def reports_of(path: Path) -> str:
    """The name of the table of reports: their bodies are compressed in a later one."""
    ((name,),) = rows(path, "SELECT name FROM sqlite_schema WHERE name IN ('report', 'kept_report')")
    return str(name)


def test_there_is_one_of_each() -> None:
    assert len(STORES) == 5


def test_all_that_was_kept_is_there(kept: Path) -> None:
    ((before,),) = rows(kept, "SELECT state FROM ledger WHERE robot = 'R'")
    bodies = [body for (body,) in rows(kept, f"SELECT body FROM {reports_of(kept)} ORDER BY time")]
    reports = [json.loads(zlib.decompress(body) if isinstance(body, bytes) else body) for body in bodies]
    done = rows(kept, "SELECT recording, complete FROM progress")
    with SqliteStore(kept) as store:
        assert store.ledger("R") == json.loads(before)
        assert list(store.history("R").reports()) == reports
        assert [(name, int(store.progress("R", name).complete)) for name, _ in done] == done
    with SqliteStore(kept) as store:  # and is so when it is opened again
        assert store.ledger("R") == json.loads(before)
    assert rows(kept, "PRAGMA user_version") == [(4,)]


def test_it_is_gone_on_with(kept: Path, tmp_path: Path) -> None:
    """As if the whole drive had been heard by the version of now."""
    robot = load(FORMATS / "robot.yaml")
    with SqliteStore(kept) as store:
        replay(robot, written(tmp_path / "next.csv", 7200, 10800), store=store)
        there = Ledger.of(robot, store.ledger("R") or {})
    whole = MemoryStore()
    replay(robot, written(tmp_path / "all.csv", 0, 10800), store=whole)
    once = Ledger.of(robot, whole.ledger("R") or {})
    for name in ("age", "effective", "hazard", "clocks"):
        assert getattr(there, name).value == pytest.approx(getattr(once, name).value, rel=1e-12)
    assert (there.started, there.integrated_to, there.newest) == (once.started, once.integrated_to, once.newest)
    assert not there.counts
    for name in ("age", "effective"):
        total = np.sum([getattr(step, name) for step in there.history], axis=0)
        assert total == pytest.approx(getattr(there, name).value, rel=1e-12)
    assert sum(step.calendar for step in there.history) * HOUR == pytest.approx(
        (once.integrated_to or 0) - BEGIN * SECOND, rel=1e-12
    )


def test_a_recording_that_was_replayed_then_counts_no_second_time(kept: Path, tmp_path: Path) -> None:
    robot = load(FORMATS / "robot.yaml")
    with SqliteStore(kept) as store:
        before = store.ledger("R")
        with suppress(SourceError):  # of a version that named recordings in another way: it would come too late
            replay(robot, written(tmp_path / "drive.csv", 0, 7200), store=store)
        now = store.ledger("R")
    assert before
    assert now
    assert now["totals"] == before["totals"]


def test_alarms_and_requests_of_a_version_3_are_there(tmp_path: Path) -> None:
    """A request that was damaged, which its checksum there tells, is not."""
    path = tmp_path / "past.db"
    path.write_bytes(gzip.decompress((FORMATS / "store_3_ledger_2.db.gz").read_bytes()))
    with SqliteStore(path) as store:
        found = {one["what"]: one for one in store.alarm_log("R").alarms()}
        assert {name: (one["number"], one["begin"], one["end"]) for name, one in found.items()} == {
            "hot": (1, (BEGIN + 5) * SECOND, None),
            "cold": (2, (BEGIN + 9) * SECOND, (BEGIN + 12) * SECOND),
            "loud": (3, (BEGIN + 30) * SECOND, None),
        }
        assert [one["acknowledged_by"] for one in found.values() if one["acknowledged_at"] is not None] == ["Ada"]
        requests = store.service_requests("R")
        assert requests.waiting() == [ServiceRequest("second", {"part": "motor", "by": "Ada"})]
        assert requests.answer("first") == {"done": []}
    path.write_bytes(gzip.decompress((FORMATS / "store_3_ledger_2.db.gz").read_bytes()))
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("""UPDATE service_request SET asked = '{"part": "rotor"}' WHERE key = 'second'""")
    with SqliteStore(path) as store:
        assert store.service_requests("R").waiting() == []


def test_a_journal_is_read(tmp_path: Path) -> None:
    source = JournalRecording(FORMATS / "journal_1.journal")
    heard = Counter(sample.signal for sample in source.samples(["/motor.temperature"]))
    assert heard == {"/motor.temperature": 120, CLOCK: 10}
    assert not source.notes


def test_a_move_that_ends_on_the_way_leaves_the_store_as_it_was(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = reports_of(kept)
    before = rows(kept, "SELECT * FROM ledger"), rows(kept, f"SELECT * FROM {name}"), rows(kept, "PRAGMA user_version")

    def full(*_: object) -> None:
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr("robophm.stores.migration.make_tables", full)
    with pytest.raises(StoreError, match="disk is full"):
        SqliteStore(kept)
    now = rows(kept, "SELECT * FROM ledger"), rows(kept, f"SELECT * FROM {name}"), rows(kept, "PRAGMA user_version")
    assert now == before


def test_a_ledger_of_a_newer_version_is_refused_in_words() -> None:
    robot = load(FORMATS / "robot.yaml")
    newer = Ledger.new(robot).to_json() | {"version": 3}
    with pytest.raises(StoreError, match="ledger version 3, of a newer robophm; this one knows up to version 2"):
        Ledger.of(robot, newer)


def test_how_far_a_version_1_had_come_within_a_recording_is_not_believed(tmp_path: Path) -> None:
    """It was counted in samples, and now is in time."""
    path = tmp_path / "past.db"
    path.write_bytes(gzip.decompress((FORMATS / "store_1_ledger_1.db.gz").read_bytes()))
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("INSERT INTO progress VALUES ('R', 'half', 500, 0)")
    with SqliteStore(path) as store:
        assert store.progress("R", "half") == Progress("half")
