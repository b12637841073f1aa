"""What a robot's store keeps for its fleet: numbers, thinning, and what damage, copies and crashes leave of it."""

from __future__ import annotations

import shutil
import sqlite3
from itertools import accumulate

import pytest

from robophm.core.errors import StoreError
from robophm.stores import outbox as outboxes
from robophm.stores._good_state import make_anew
from robophm.stores.memory import MemoryStore
from robophm.stores.outbox import BOUNDS, COLUMNS, report_values
from robophm.stores.sqlite import SqliteStore

MINUTE = 60 * 10**9


def report(minute, **more):
    view = {"hazard_rate": 1e-4, "unreliability": 0.5, "remaining_life": {"median": float("inf")}}
    return {"time": minute * MINUTE, "clocks": {"operating": minute / 60},
            "subjects": [{"nominal": view, "sensor_based": view}], "state": "warn", **more}  # fmt: skip


@pytest.fixture
def store(tmp_path):
    with SqliteStore(tmp_path / "robot.db") as opened:
        opened.outboxes.of("r").begin()
        yield opened


@pytest.fixture
def memory():
    store = MemoryStore()
    store.outboxes.of("r").begin()
    return store


def save(store, *minutes, robot="r"):
    store.save(robot, {"at": minutes}, reports=[report(one) for one in minutes])


def numbers(store, robot="r"):
    return [(one.seq, one.thinned) for one in store.outboxes.of(robot).batch(10**6).reports]


def test_reports_come_in_with_the_save_that_keeps_them(store):
    save(store, 1, 2)
    save(store, 3)
    batch = store.outboxes.of("r").batch(10)
    assert [(one.seq, one.time // MINUTE, one.thinned) for one in batch.reports] == [(1, 1, 0), (2, 2, 0), (3, 3, 0)]
    assert batch.left == 0
    assert batch.present.revision == 2
    assert batch.present.ledger == '{"at": [3]}'
    assert batch.present.report == report(3)
    assert len({one.epoch for one in batch.reports} | {batch.present.epoch}) == 1


def test_what_is_not_saved_is_not_in_it(store):
    with SqliteStore(store.path) as other:
        other.save("r", {"at": "elsewhere"})
        store._revisions["r"] = 0
        with pytest.raises(StoreError, match="another process"):
            save(store, 1)
    assert store.outboxes.of("r").count() == 0


def test_nothing_is_put_in_by_who_did_not_begin(store):
    with SqliteStore(store.path) as other:
        other.save("r", {}, reports=[report(1)])
        assert other.outboxes.of("r").count() == 0
        assert other.outboxes.of("unheard of").count() == 0


def test_a_store_without_an_outbox_has_an_empty_one(tmp_path):
    with SqliteStore(tmp_path / "plain.db") as plain:
        plain.save("r", {}, reports=[report(1)])
        assert plain.outboxes.of("r").count() == 0
        assert plain.outboxes.of("r").batch(5) == ((), 0, None)


def test_what_is_committed_is_let_go_of_and_numbers_go_on(store):
    save(store, 1, 2, 3)
    batch = store.outboxes.of("r").batch(2)
    assert (len(batch.reports), batch.left, batch.present) == (2, 1, None)
    store.outboxes.of("r").trim(batch.reports[-1].number)
    save(store, 4)
    assert numbers(store) == [(3, 0), (4, 0)]


def test_a_batch_ends_with_its_epoch_and_the_state_waits_for_what_is_older(store):
    save(store, 1, 2)
    store.outboxes.of("r").begin()
    save(store, 3)
    first = store.outboxes.of("r").batch(10)
    assert ([one.seq for one in first.reports], first.left, first.present) == ([1, 2], 1, None)
    store.outboxes.of("r").trim(first.reports[-1].number)
    second = store.outboxes.of("r").batch(10)
    assert [one.seq for one in second.reports] == [1]
    assert second.present.epoch == second.reports[0].epoch != first.reports[0].epoch


def test_a_state_of_a_new_epoch_waits_for_reports_of_the_one_before(store):
    save(store, 1)
    store.outboxes.of("r").begin()
    batch = store.outboxes.of("r").batch(10)
    assert len(batch.reports) == 1
    assert batch.present is None


def test_robots_do_not_see_each_other(store):
    store.outboxes.of("s").begin()
    save(store, 1)
    save(store, 7, 8, robot="s")
    assert numbers(store) == [(1, 0)]
    assert numbers(store, "s") == [(1, 0), (2, 0)]
    store.outboxes.of("s").trim(10**6)
    assert store.outboxes.of("r").count() == 1


@pytest.mark.parametrize("most", [1, 2, 7, 20])
def test_an_outbox_that_is_full_is_thinned_and_every_number_is_accounted_for(memory, monkeypatch, most):
    monkeypatch.setattr(outboxes, "MOST_WAITING", most)
    for minute in range(1, 101):
        save(memory, minute)
        waits = numbers(memory)
        assert len(waits) <= most
        assert waits[-1][0] == minute  # the newest is never let go of
        ends = [*accumulate(thinned + 1 for _, thinned in waits)]
        assert ends == [seq for seq, _ in waits]
    if most == 20:
        assert max(thinned for _, thinned in waits) <= 15  # evenly: of 100 into 20 none stands for more than 16


def test_thinning_goes_over_epochs_where_each_has_one_report(memory, monkeypatch):
    monkeypatch.setattr(outboxes, "MOST_WAITING", 3)
    for minute in range(1, 11):
        memory.outboxes.of("r").begin()
        save(memory, minute)
    left = []
    while batch := memory.outboxes.of("r").batch(10).reports:
        left += batch
        memory.outboxes.of("r").trim(batch[-1].number)
    assert len(left) == 3
    assert sum(one.thinned + 1 for one in left) == 10


def test_a_copy_never_gives_a_number_twice(store, tmp_path):
    save(store, 1)
    store.upkeep().copy_to(tmp_path / "copy.db")
    save(store, 2)
    mine = {(one.epoch, one.seq) for one in store.outboxes.of("r").batch(10).reports}
    shutil.copy(tmp_path / "copy.db", tmp_path / "again.db")
    with SqliteStore(tmp_path / "again.db") as copy:
        copy.outboxes.of("r").begin()
        save(copy, 3)
        copy.outboxes.of("r").trim(1)  # what both have
        assert not mine & {(one.epoch, one.seq) for one in copy.outboxes.of("r").batch(10).reports}


def test_a_damaged_row_is_left_out_and_the_others_are_sent(store):
    save(store, 1, 2, 3)
    with sqlite3.connect(store.path) as base:
        base.execute("UPDATE outbox SET time = time + 1 WHERE seq = 2")
    assert numbers(store) == [(1, 0), (3, 0)]
    store.outboxes.of("r").trim(3)
    assert store.outboxes.of("r").count() == 0


def test_values_are_those_of_the_report():
    ahead = [{"horizon": hours, "sensor_based_failure": hours / 1000, "bound": "at least"} for hours in (24, 168, 720)]
    values = dict(zip(COLUMNS, report_values(report(60, failure_within=ahead)), strict=True))
    assert values["hazard_rate.sensor_based"] == 1e-4
    assert values["remaining_life.nominal"] == "Infinity"
    assert values["task_failure.nominal"] is None
    assert values["operating"] == 1.0
    assert [values[f"failure_within.{hours}"] for hours in (24, 168, 720)] == [0.024, 0.168, 0.72]
    assert BOUNDS[int(values["bound"])] == "at least"
    assert report_values(report(60))[-4:] == [None] * 4  # silence is no zero


def test_a_store_that_is_made_anew_keeps_what_waits_but_for_what_is_damaged(tmp_path):
    path = tmp_path / "robot.db"
    with SqliteStore(path) as store:
        store.outboxes.of("r").begin()
        save(store, 1, 2, 3, 4)
        before = store.outboxes.of("r").batch(10).reports
    with sqlite3.connect(path) as base:
        base.execute("UPDATE outbox SET figures = '[1]' WHERE seq = 2")
        base.execute("UPDATE kept_report SET body = zeroblob(3) WHERE time = ?", (2 * MINUTE,))
    assert make_anew(path) is not None
    with SqliteStore(path) as store:
        batch = store.outboxes.of("r").batch(10)
        assert batch.reports == tuple(one for one in before if one.seq != 2)
        assert batch.present.ledger == '{"at": [1, 2, 3, 4]}'
        store.outboxes.of("r").begin()
        save(store, 5)
        assert numbers(store) == [(1, 0), (3, 0), (4, 0)], "of one epoch at a time"
