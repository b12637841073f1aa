"""The fleet's store in each engine: what came is there once, what is missing is known, what is newest is told."""

from __future__ import annotations

import random
import sqlite3
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from importlib import import_module

import pytest
from tests.fleet.postgresql_server import missing

from robophm.core.errors import RobophmError, StoreError
from robophm.fleet.engines import engine as engine_of_any
from robophm.fleet.engines import sqlite
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.questions import present, reports, status, worst
from robophm.fleet.store import FleetStore
from robophm.fleet.tables import VERSION
from robophm.stores.outbox import COLUMNS

postgresql = None if missing() else import_module("robophm.fleet.engines.postgresql")
A, B = "a" * 16, "b" * 16


@pytest.fixture
def store(address):
    with FleetStore(address, make=True) as opened:
        opened.add_token("r")
        yield opened


def commit(store, one):
    """What is committed of one payload."""
    return store.commit([one])[0]


def changed(address, *statements):
    """Change the tables behind the store's back."""
    if "://" in address:
        psycopg = pytest.importorskip("psycopg")
        with psycopg.connect(address, autocommit=True, options="-c search_path=robophm_fleet") as base:
            for one in statements:
                base.execute(one)
    else:
        with closing(sqlite3.connect(address)) as base, base:
            for one in statements:
                base.execute(one)


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
    assert commit(store, payload(1, 2, 3, revision=5)) == (A, 3, 3, 0)
    before = [*reports(store)]
    assert commit(store, payload(2, 3, 4, revision=5)) == (A, 4, 1, 2)
    assert commit(store, payload(1, 2, 3, chance=0.9)) == (A, 3, 0, 3)
    assert [*reports(store)][:3] == before
    (one,) = status(store)
    assert (one.reports, one.thinned, one.missing) == (4, 0, 0)


def test_any_order_any_repeats_and_any_cut_into_payloads_and_commits_give_the_same(store):
    """Against a plain set, with what was let go of counted by intervals."""
    chance = random.Random(3)
    for trial in range(12):
        robot = f"r{trial:02}"
        store.add_token(robot)
        rows, at = [], 0
        while at < 30:
            thinned = chance.choice([0, 0, 0, 1, 3])
            at += thinned + 1
            rows.append((at, thinned))
        lost = {one for one in rows[:-1] if chance.random() < 0.1}
        come = [one for one in rows if one not in lost]
        parts = [sorted(chance.sample(come, chance.randint(1, len(come)))) for _ in range(10)] + [come]
        waiting, new = [payload(*part, robot=robot) for part in parts], 0
        while waiting:
            many = chance.choice([1, 1, 2, 5])
            some, waiting = waiting[:many], waiting[many:]
            new += sum(one.new for one in store.commit(some))
        covered = {number for seq, thinned in come for number in range(seq - thinned, seq + 1)}
        one = status(store)[-1]
        assert (one.robot, one.reports, new) == (robot, len(come), len(come))
        assert [(row.seq, row.thinned) for row in reports(store, robot)] == come
        assert one.missing == come[-1][0] - len(covered)
        assert one.reports + one.thinned + one.missing == come[-1][0]


def test_what_is_committed_together_is_as_one_after_the_other(address, store):
    """Epochs that begin, repeats and older ledgers of one robot in one commit, beside a robot of its own."""
    store.add_token("s")
    some = [payload(1, 2, revision=7), payload(1, 2, revision=7), payload(1, epoch=B, chance=0.2, revision=3),
            payload(3, chance=0.9, revision=8), payload(2, epoch=B, chance=0.3, revision=4)]  # fmt: skip
    together = store.commit(some)
    alone = [commit(store, one._replace(robot="s")) for one in some]
    assert together == alone
    assert [one.new for one in alone] == [2, 0, 1, 1, 1]
    r, s = status(store)
    assert (r.reports, r.missing, r.thinned, r.refused) == (s.reports, s.missing, s.thinned, s.refused)
    assert [one[1:4] for one in reports(store, "r")] == [one[1:4] for one in reports(store, "s")]
    assert present(store, "r") == present(store, "s")
    assert [one.chance for one in worst(store, 168.0, 9).robots] == [pytest.approx(0.3)] * 2


def test_the_newest_is_told_by_epoch_and_number(store):
    commit(store, payload(1, 2, chance=0.1, revision=7))
    commit(store, payload(1, epoch=B, chance=0.2, revision=3))
    assert [one.chance for one in worst(store, 168.0, 9).robots] == [pytest.approx(0.2)]
    assert present(store, "r")[0] == '{"of": 3}'
    commit(
        store, payload(3, chance=0.9, revision=8)
    )  # of the epoch before: another machine, or an answer that was late
    assert [one.chance for one in worst(store, 168.0, 9).robots] == [pytest.approx(0.2)]
    assert present(store, "r")[0] == '{"of": 3}'
    (one,) = status(store)
    assert one.reports == 4
    store.keep_counts()
    assert any("two machines" in why for why in status(store)[0].refused)


def test_an_older_ledger_that_comes_late_is_not_taken(store):
    commit(store, payload(revision=2))
    commit(store, payload(revision=1))
    assert present(store, "r")[0] == '{"of": 2}'


def test_a_payload_is_kept_whole_or_not_at_all(address, store):
    changed(address, "ALTER TABLE present RENAME TO elsewhere")
    with pytest.raises(StoreError, match="present"):
        store.commit([payload(1, 2, revision=1)])
    assert [*reports(store)] == []
    changed(address, "ALTER TABLE elsewhere RENAME TO present")
    assert commit(store, payload(1, 2, revision=1)).new == 2


def test_a_damaged_report_or_ledger_is_said(address, store):
    commit(store, payload(1, revision=1))
    changed(address, "UPDATE report SET time = time + 1", "UPDATE present SET sum = sum + 1")
    with pytest.raises(StoreError, match="checksum"):
        [*reports(store)]
    with pytest.raises(StoreError, match="checksum"):
        present(store, "r")


def test_a_token_is_of_one_robot_and_another_ends_it(store):
    token = store.add_token("s")
    assert store.robot_of(token) == "s"
    again = store.add_token("s")
    assert (store.robot_of(token), store.robot_of(again)) == (None, "s")
    assert token.encode() not in {kept for (kept,) in store.rows("SELECT token FROM robot")}


def test_two_who_write_to_one_store_lose_nothing(address, store):
    """Each robot's reports come in turn through either."""
    with FleetStore(address) as other:
        stores = [store, other]

        def write(which):
            for at in range(1, 21):
                stores[which].commit([payload(at + 20 * which, robot="r")])

        with ThreadPoolExecutor(2) as both:
            [*both.map(write, range(2))]
    (one,) = status(store)
    assert (one.reports, one.missing) == (40, 0)


def test_an_older_version_is_brought_to_this_one_and_a_newer_one_refused(address, monkeypatch):
    FleetStore(address, make=True).close()
    engine = postgresql if "://" in address else sqlite
    for one in (engine, engine_of_any):
        monkeypatch.setattr(one, "VERSION", VERSION + 1)
    monkeypatch.setitem(engine.STEPS, VERSION, ["ALTER TABLE robot ADD COLUMN colour TEXT"])
    with FleetStore(address) as store:
        assert store.rows("SELECT colour FROM robot") == []
    FleetStore(address).close()
    monkeypatch.undo()
    with pytest.raises(StoreError, match=f"of version {VERSION + 1}; this robophm knows up to version {VERSION}"):
        FleetStore(address)


@pytest.mark.parametrize("name", ["", " r", "a/b", "x" * 101, "line\nbreak"])
def test_names_that_no_robot_can_have(store, name):
    with pytest.raises(RobophmError, match="expected a name"):
        store.add_token(name)


def test_what_was_refused_is_counted_and_kept(address):
    with FleetStore(address, make=True) as store:
        store.add_token("r")
        for _ in range(3):
            store.refuse("r", "malformed payload")
    with FleetStore(address) as store:
        store.refuse("r", "malformed payload")
    with FleetStore(address) as store:
        assert status(store)[0].refused == {"malformed payload": 4}


def test_there_must_be_a_store_to_be_asked(address):
    with pytest.raises(StoreError, match="expected a fleet's store, as robophm fleet serve and token make it"):
        FleetStore(address)


def test_a_site_is_kept_until_another_is_said(store):
    store.add_token("r", "Kiel")
    store.add_token("r")
    assert store.rows("SELECT site FROM robot") == [("Kiel",)]
    with pytest.raises(RobophmError, match="site ''"):
        store.add_token("r", "")
