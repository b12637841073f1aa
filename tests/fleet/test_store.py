"""The fleet's store: what came is there once, what is missing is known, and what is newest is told by number."""

from __future__ import annotations

import random
import sqlite3
import time

import pytest

from robophm.core.errors import RobophmError, StoreError
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.questions import present, reports, status, worst
from robophm.fleet.store import FleetStore
from robophm.fleet.tables import VERSION
from robophm.stores.outbox import COLUMNS

A, B = "a" * 16, "b" * 16


@pytest.fixture
def store(tmp_path):
    with FleetStore(tmp_path / "fleet.db", make=True) as opened:
        opened.add_token("r")
        yield opened


def figures(chance=0.5):
    values = dict.fromkeys(COLUMNS, 0.25) | {"failure_within.168": chance, "state": 0.0, "bound": 0.0}
    return tuple(values[name] for name in COLUMNS)


def payload(*numbers, epoch=A, revision=None, robot="r", chance=0.5, sent=None):
    """Reports of some numbers, or pairs of a number and how many before it were let go of."""
    rows = [Report(*((one, 10**18, 0) if isinstance(one, int) else (one[0], 10**18, one[1])), figures(chance))
            for one in numbers]  # fmt: skip
    state = None if revision is None else PresentState(revision, f'{{"of": {revision}}}', {"robot": "c"}, ())
    return Payload(robot, epoch, time.time_ns() if sent is None else sent, 0, tuple(rows), state)


def test_what_comes_again_changes_nothing(store):
    assert store.commit(payload(1, 2, 3, revision=5)) == (A, 3, 3, 0)
    before = [*reports(store)]
    assert store.commit(payload(2, 3, 4, revision=5)) == (A, 4, 1, 2)
    assert store.commit(payload(1, 2, 3, chance=0.9)) == (A, 3, 0, 3)
    assert [*reports(store)][:3] == before
    (one,) = status(store)
    assert (one.reports, one.thinned, one.missing) == (4, 0, 0)


def test_any_order_any_repeats_and_any_cut_into_payloads_give_the_same(tmp_path):
    """Against a plain set, with what was let go of counted by intervals."""
    chance = random.Random(3)
    for trial in range(15):
        with FleetStore(tmp_path / f"{trial}.db", make=True) as store:
            store._base.execute("PRAGMA synchronous = OFF")
            store.add_token("r")
            rows, at = [], 0
            while at < 30:
                thinned = chance.choice([0, 0, 0, 1, 3])
                at += thinned + 1
                rows.append((at, thinned))
            lost = {one for one in rows[:-1] if chance.random() < 0.1}
            come = [one for one in rows if one not in lost]
            parts = [sorted(chance.sample(come, chance.randint(1, len(come)))) for _ in range(10)] + [come]
            for part in parts:
                store.commit(payload(*part))
            covered = {number for seq, thinned in come for number in range(seq - thinned, seq + 1)}
            (one,) = status(store)
            assert [(row.seq, row.thinned) for row in reports(store)] == come
            assert one.reports == len(come)
            assert one.missing == come[-1][0] - len(covered)
            assert one.reports + one.thinned + one.missing == come[-1][0]


def test_the_newest_is_told_by_epoch_and_number(store):
    store.commit(payload(1, 2, chance=0.1, revision=7))
    store.commit(payload(1, epoch=B, chance=0.2, revision=3))
    assert [one.chance for one in worst(store, 168.0, 9).robots] == [pytest.approx(0.2)]
    assert present(store, "r")[0] == '{"of": 3}'
    store.commit(payload(3, chance=0.9, revision=8))  # of the epoch before: another machine, or an answer that was late
    assert [one.chance for one in worst(store, 168.0, 9).robots] == [pytest.approx(0.2)]
    assert present(store, "r")[0] == '{"of": 3}'
    (one,) = status(store)
    assert one.reports == 4
    store.keep_counts()
    assert any("two machines" in why for why in status(store)[0].refused)


def test_an_older_ledger_that_comes_late_is_not_taken(store):
    store.commit(payload(revision=2))
    store.commit(payload(revision=1))
    assert present(store, "r")[0] == '{"of": 2}'


def test_a_payload_is_kept_whole_or_not_at_all(store, monkeypatch):
    monkeypatch.setattr(store, "_keep_present", lambda *_: (_ for _ in ()).throw(sqlite3.OperationalError("full")))
    with pytest.raises(StoreError, match="full"):
        store.commit(payload(1, 2, revision=1))
    assert [*reports(store)] == []
    monkeypatch.undo()
    assert store.commit(payload(1, 2, revision=1)).new == 2


def test_a_damaged_report_or_ledger_is_said(store):
    store.commit(payload(1, revision=1))
    with sqlite3.connect(store.path) as base:
        base.execute("UPDATE report SET time = time + 1")
        base.execute("UPDATE present SET ledger = zeroblob(9)")
    with pytest.raises(StoreError, match="checksum"):
        [*reports(store)]
    with pytest.raises(StoreError, match="checksum"):
        present(store, "r")


def test_a_token_is_of_one_robot_and_another_ends_it(store):
    token = store.add_token("s")
    assert store.robot_of(token) == "s"
    again = store.add_token("s")
    assert (store.robot_of(token), store.robot_of(again)) == (None, "s")
    assert token.encode() not in store.path.read_bytes() + store.path.with_name("fleet.db-wal").read_bytes()
    assert store.path.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("name", ["", " r", "a/b", "x" * 101, "line\nbreak"])
def test_names_that_no_robot_can_have(store, name):
    with pytest.raises(RobophmError, match="expected a name"):
        store.add_token(name)


def test_other_files_are_refused(tmp_path):
    with pytest.raises(StoreError, match="no such file; expected a fleet's store"):
        FleetStore(tmp_path / "none.db")
    (tmp_path / "text").write_text("no base " * 200)
    with pytest.raises(StoreError, match="expected a fleet's store"):
        FleetStore(tmp_path / "text")
    with sqlite3.connect(tmp_path / "other.db") as base:
        base.execute("CREATE TABLE robot (name TEXT)")
    with pytest.raises(StoreError, match="is no fleet's store"):
        FleetStore(tmp_path / "other.db")
    with FleetStore(tmp_path / "newer.db", make=True) as store:
        store._base.execute(f"PRAGMA user_version = {VERSION + 1}")
    with pytest.raises(StoreError, match="this robophm knows up to"):
        FleetStore(tmp_path / "newer.db")


def test_what_was_refused_is_counted_and_kept(tmp_path):
    with FleetStore(tmp_path / "fleet.db", make=True) as store:
        store.add_token("r")
        for _ in range(3):
            store.refuse("r", "malformed payload")
    with FleetStore(tmp_path / "fleet.db") as store:
        assert status(store)[0].refused == {"malformed payload": 3}
