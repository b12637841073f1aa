"""Old reports leave a fleet's store for the folder of days: none is lost, none comes twice, and history goes on."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest
from tests.fleet.made_reports import BEGIN, MINUTE
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.fleet import history_files, kept_days
from robophm.fleet.daily_history import DAY, write_days
from robophm.fleet.history_files import OVER
from robophm.fleet.kept_days import move_out
from robophm.fleet.payload import Payload, Report
from robophm.fleet.questions import newest_time, reports, status, worst
from robophm.fleet.robot_history import history
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")

FIRST = BEGIN // DAY * DAY
NAMES = ("a", "b", "Röntgen 50 %")
EPOCHS = ("a" * 16, "b" * 16)
SEQ = 60
"""Reports of each epoch; the tenth never came, and the twentieth says that it follows one that was let go of."""


@pytest.fixture(autouse=True)
def no_month(monkeypatch, request):
    """Of a robot that is silent a month stays; not in these days, but where that is what is tested."""
    if request.node.originalname not in ("test_the_last_month_of_a_robot_that_is_silent_stays", "test_as_people_ask"):
        monkeypatch.setattr(kept_days, "LEAST_KEPT", -100)


def made(name: str, epoch: str, seqs: range | list[int]) -> Payload:
    """Reports by the numbers, always the same ones."""
    told = []
    for seq in seqs:
        chance = np.random.default_rng([NAMES.index(name), EPOCHS.index(epoch), seq])
        figures = chance.lognormal(0, 3, len(COLUMNS))
        figures[chance.random(len(COLUMNS)) < 0.2] = np.nan
        figures[[COLUMNS.index("state"), COLUMNS.index("bound")]] = 0
        ahead = 10**18 if seq == 7 else 0
        told.append(Report(seq, FIRST + seq * MINUTE + ahead, int(seq == 20), tuple(map(float, figures))))
    return Payload(name, epoch, FIRST, 0, tuple(told), None)


COME = [seq for seq in range(1, SEQ + 1) if seq not in (10, 19)]


@pytest.fixture
def store(address):
    """Two epochs of each robot; each was received over four days."""
    with FleetStore(address, make=True) as opened:
        for name in NAMES:
            opened.add_token(name)
            for epoch in EPOCHS:
                opened.commit([made(name, epoch, COME)])
        changed(opened, f"received = {FIRST} + (seq / 16) * {DAY} + seq * {MINUTE}")
        yield opened


def changed(store, how, *values):
    with store.writing() as engine:
        engine.ask(f"UPDATE report SET {how} RETURNING robot", values)


def asked(store, folder=None):
    """All that is asked of reports: counts, the worst, and courses, whole and joined to points."""
    found = []
    for name in NAMES:
        found.append(newest_time(store, name))
        for start, end, points in (
            (None, None, 10_000),
            (None, None, 20),
            (FIRST + 9 * MINUTE, FIRST + 40 * MINUTE, 8),
        ):
            one = history(store, name, start, end, points, folder)
            found += [*(each.tobytes() for each in one.series[1:]), one.series.width, one.ahead, one.elsewhere]
    counts = [(one.state, one.time, one.reports, one.thinned, one.missing) for one in status(store)]
    return [*found, counts, repr([one[:-1] for one in worst(store, 24.0, 9).robots])]


def test_what_was_moved_is_answered_as_before(store, tmp_path, monkeypatch):
    monkeypatch.setattr(history_files, "AT_ONCE", 7)  # several reads of a day
    folder, before = tmp_path / "days", asked(store)
    write_days(store, folder, FIRST + 9 * DAY)
    assert asked(store, folder) == before, "nothing was moved yet, and nothing is told twice"
    old = [one for one in reports(store) if one.received < FIRST + 2 * DAY]
    said = []
    assert move_out(store, folder, FIRST + 2 * DAY + 5, lambda *done: said.append(done)) == (len(old), 0)
    assert said == [(1, 2), (2, 2)]
    assert len(old) == 2 * len(NAMES) * sum(seq < 32 for seq in COME)
    assert not [one for one in reports(store) if one.received < FIRST + 2 * DAY]
    assert asked(store, folder) == before
    assert move_out(store, folder, FIRST + 2 * DAY) == (0, 0)
    assert history(store, "a", None, None, 9).elsewhere == len(old) / len(NAMES)
    move_out(store, folder, FIRST + 9 * DAY)
    assert [*reports(store)] == []
    counts = [(one.reports, one.thinned, one.missing) for one in status(store)]
    assert counts == [(2 * len(COME), 2, 2)] * len(NAMES)
    found = history(store, "b", None, None, 10_000, folder)
    assert (len(found.series.times), found.ahead, found.elsewhere) == (2 * len(COME) - 2, 2, 0)


def test_what_comes_again_after_it_was_moved_changes_nothing_and_what_is_new_counts(store, tmp_path):
    folder = tmp_path / "days"
    write_days(store, folder, FIRST + 9 * DAY)
    move_out(store, folder, FIRST + 2 * DAY)
    before = asked(store, folder)
    for epoch in EPOCHS:
        (again,) = store.commit([made("a", epoch, range(1, 41))])
        assert (again.new, again.repeated) == (0, 40)  # 10 and 19 too: they could as well have been there
    assert asked(store, folder) == before
    (late,) = store.commit([made("a", EPOCHS[1], range(50, 70))])
    assert (late.new, late.repeated) == (9, 11)
    one = status(store, "a")[0]
    assert (one.reports, one.thinned, one.missing) == (2 * len(COME) + 9, 2, 2)


def test_a_gap_that_is_filled_beside_what_was_moved_counts_as_if_nothing_had_been(address, tmp_path):
    with FleetStore(address, make=True) as store:
        for name in NAMES[:2]:
            store.add_token(name)
            store.commit([made(name, EPOCHS[0], [1, 2, 4, 20, 30, 33, 34, 40])])
        changed(store, f"received = {FIRST} + (seq / 16) * {DAY} + seq WHERE robot = 1")
        changed(store, f"received = {FIRST} + 9 * {DAY} + seq WHERE robot = 2")
        write_days(store, tmp_path / "days", FIRST + 5 * DAY)
        assert move_out(store, tmp_path / "days", FIRST + 2 * DAY) == (5, 0)
        for some in ([31, 36], [50, 35], [32]):
            for name in NAMES[:2]:
                store.commit([made(name, EPOCHS[0], some)])
            a, b = status(store)
            assert (a.reports, a.thinned, a.missing) == (b.reports, b.thinned, b.missing)


@pytest.mark.parametrize("how", ["figures", "late", "no file", "damaged"])
def test_what_the_files_do_not_give_back_stays(store, tmp_path, how):
    folder = tmp_path / "days"
    write_days(store, folder, FIRST + 9 * DAY)
    (path,) = (folder / "day=2023-11-14").rglob("*.parquet")
    if how == "damaged":
        content = bytearray(path.read_bytes())
        content[len(content) // 3] ^= 4
        path.write_bytes(content)
        with pytest.raises(RobophmError, match="expected a day as robophm fleet export wrote it"):
            move_out(store, folder, FIRST + DAY)
        assert len([*reports(store)]) == 2 * len(NAMES) * len(COME)
        return
    first = len([seq for seq in COME if seq < 16])
    if how == "no file":
        path.unlink()
        assert move_out(store, folder, FIRST + DAY) == (0, 2 * len(NAMES) * first)
        return
    if how == "late":  # the fleet's clock was set back after the day had been written
        changed(store, f"received = {FIRST} + 1 WHERE robot = 1 AND epoch = 1 AND seq = 17")
        assert move_out(store, folder, FIRST + DAY) == (2 * len(NAMES) * first, 1)
        assert history(store, "a", None, None, 10_000, folder).elsewhere == 0
        return
    changed(store, "figures = (SELECT figures FROM report AS one WHERE one.robot = 1 AND epoch = 1 AND seq = 6), "
                   "seq = seq WHERE robot = 1 AND epoch = 1 AND seq = 6")  # fmt: skip
    changed(store, "thinned = 5 WHERE robot = 2 AND epoch = 2 AND seq = 3")
    assert move_out(store, folder, FIRST + DAY) == (2 * len(NAMES) * first - first, first)
    before = asked(store, folder)
    assert before == asked(store, folder)
    assert [one.thinned for one in reports(store, "b") if (one.epoch, one.seq) == (2, 3)] == [5]


def test_the_last_month_of_a_robot_that_is_silent_stays(address, tmp_path):
    """By its own clock, as what it promised in that month is compared with what became of it."""
    with FleetStore(address, make=True) as store:
        for name, ended in (("a", 50), ("b", 90)):
            store.add_token(name)
            told = [Report(day, FIRST + day * DAY, 0, (0.0,) * len(COLUMNS)) for day in range(1, ended + 1)]
            store.commit([Payload(name, EPOCHS[0], FIRST, 0, tuple(told), None)])
        changed(store, f"received = time + {5 * SECOND}")
        write_days(store, tmp_path / "days", FIRST + 100 * DAY)
        assert move_out(store, tmp_path / "days", FIRST + 60 * DAY) == (18 + 58, 0)
        assert [one.seq for one in reports(store, "a")] == [*range(19, 51)]
        assert [one.seq for one in reports(store, "b")] == [*range(59, 91)]


def test_as_people_ask(address, tmp_path):
    def robophm(*words, code=0):
        done = CliRunner().invoke(app, ["fleet", *map(str, words)])
        assert done.exit_code == code, (done.output, done.exception)
        return done

    now, days = time.time_ns(), tmp_path / "days"
    with FleetStore(address, make=True) as store:
        store.add_token("a")
        told = [Report(seq, now - (60 - seq) * DAY - SECOND, 0, (0.0,) * len(COLUMNS)) for seq in range(1, 61)]
        store.commit([Payload("a", EPOCHS[0], now, 0, tuple(told), None)])
        changed(store, f"received = time + {SECOND}")
    words = ("export", "--store", address, "--to", days)
    assert "expected '31 day' or more" in str(robophm(*words, "--keep", "1 week", code=1).exception)
    assert "expected no .csv in --to" in str(robophm(*words[:-1], "x.csv", "--keep", "40 day", code=1).exception)
    said = json.loads(robophm(*words, "--keep", "40 day", "--json").stdout)
    assert said["moved"] in ({"reports": 19, "kept": 0}, {"reports": 20, "kept": 0})  # by the hour
    assert "Moved out of the store: 0 reports" in robophm(*words, "--keep", "40 day").stdout
    alone = robophm("history", "a", "--store", address)
    count = said["moved"]["reports"]
    assert f"{count} reports are not in the store; expected --parquet" in " ".join(alone.stderr.split())
    whole = json.loads(robophm("history", "a", "--store", address, "--parquet", days, "--json").stdout)
    assert (len(whole["times"]), whole["elsewhere"], whole["left_out"]) == (60, 0, 0)
    none = robophm("history", "a", "--store", address, "--parquet", tmp_path / "none", code=1)
    assert "no such folder" in str(none.exception)


def test_a_day_that_is_not_over_stays(store, tmp_path):
    folder = tmp_path / "days"
    write_days(store, folder, FIRST + DAY + OVER)
    assert move_out(store, folder, FIRST + 2 * DAY - 1) == (2 * len(NAMES) * sum(seq < 16 for seq in COME), 0)
