"""What is asked of a fleet: the engine's own figures, worst first, and histories by plain arithmetic."""

from __future__ import annotations

import numpy as np
import pytest
from tests.fleet.conftest import wait_for
from tests.fleet.made_reports import BEGIN, MINUTE

import robophm
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.fleet.payload import Ahead, Payload, PresentState, Report
from robophm.fleet.questions import horizon_of, reports, status, worst
from robophm.fleet.robot_history import history
from robophm.fleet.sender import Sender
from robophm.fleet.store import FleetStore
from robophm.health.failure_within import failure_within
from robophm.monitoring.live_loop import watch
from robophm.monitoring.monitor import Monitor
from robophm.stores.outbox import COLUMNS, HORIZONS
from robophm.stores.sqlite import SqliteStore
from robophm.transports.synthetic import SyntheticOta

OTA = "examples/ota/robot.yaml"


def figures(**known):
    return tuple({**dict.fromkeys(COLUMNS, np.nan), **known}.get(name) for name in COLUMNS)


def commit(store, robot, *rows, present=None, epoch="c" * 16):
    """Rows of seq, minute and the probability of failing within a week."""
    told = tuple(Report(seq, BEGIN + round(minute * MINUTE), 0,
                        figures(**{"failure_within.168": chance, "state": 1.0, "bound": 1.0, "operating": minute}))
                 for seq, minute, chance in rows)  # fmt: skip
    store.commit([Payload(robot, epoch, BEGIN, 0, told, present)])


@pytest.fixture
def store(tmp_path):
    with FleetStore(tmp_path / "fleet.db", make=True) as opened:
        for name in ("a", "b", "c", "d"):
            opened.add_token(name)
        yield opened


def test_what_comes_to_the_fleet_is_what_the_engine_says(fleet, tmp_path):
    """The paper's robot watched for five minutes: chances of its last report, from the ledger that came with it."""
    robot = robophm.load(OTA)
    source = SyntheticOta(seed=3, duration=300 * SECOND, working_hours=(0, 24))
    with FleetStore(fleet.path) as store, SqliteStore(tmp_path / "robot.db") as kept:
        token = store.add_token("ota-7")
        monitor = watch(robot, source, store=kept, period=10.0, for_fleet=True)
        with Sender(kept.path, robot.identity, fleet.of("ota-7"), token, print, look_every=0.02):
            wait_for(lambda: len([*reports(store)]) >= 5)
        newest = [*kept.history(robot.identity).reports()][-1]
        for at, hours in enumerate(HORIZONS):
            (one,) = worst(store, hours, 5).robots
            said = newest["failure_within"][at]
            assert (one.robot, one.time, one.bound, one.first) == ("ota-7", newest["time"], None, said["first"])
            assert one.chance == pytest.approx(said["sensor_based_failure"], rel=1e-6)
        figures_there = kept.history(robot.identity).figures()
        here = history(store, "ota-7", None, None, 1000).series
        assert here.times.tolist() == figures_there.times.tolist()
        np.testing.assert_array_equal(here.mean[:, :10], figures_there.mean)
    assert monitor.ledger.integrated_to >= newest["time"]


def test_the_chance_within_a_horizon_is_that_of_the_curve_ahead():
    """One part of rate λ that always operates fails within h hours by 1 − exp(−λ·h); its share is all of it."""
    robot = parse("schema_version: 1\nname: one\ncomponents: {motor: {rate: 500 FPMH}}\n")
    report = Monitor(robot).report(remaining_life="robot")
    for one in failure_within(report, HORIZONS):
        assert one["sensor_based_failure"] == pytest.approx(-np.expm1(-500e-6 * one["horizon"]), rel=1e-9)
        assert (one["operating"], one["first"], one["share"], one["bound"]) == (one["horizon"], "motor", 1.0, None)


def test_worst_first_and_what_is_not_known_is_no_zero(store):
    ahead = (Ahead(168.0, 0.3, "Power/Battery", 0.75),)
    commit(store, "a", (1, 0, 0.1))
    state = PresentState(1, "{}", {"robot": "c", "design_hash": "x", "time": BEGIN + MINUTE}, ahead)
    commit(store, "b", (1, 0, 0.2), (2, 1, 0.3), present=state)
    commit(store, "c", (1, 0, np.nan))
    found = worst(store, 168.0, 5)
    assert [one.robot for one in found.robots] == ["b", "a"]
    assert (found.of, found.unknown) == (2, 2)  # c has sent no such figure, d nothing at all
    assert (found.robots[0].first, found.robots[0].share, found.robots[0].bound) == ("Power/Battery", 0.75, "at least")
    assert found.robots[1].first is None
    assert [one.robot for one in worst(store, 168.0, 1).robots] == ["b"]
    assert worst(store, 24.0, 5).robots == []
    assert [(one.robot, one.state, one.reports) for one in status(store)] == [
        ("a", "warn", 1), ("b", "warn", 2), ("c", "warn", 1), ("d", None, 0),
    ]  # fmt: skip


def test_the_part_of_an_older_report_is_not_said_of_a_newer_one(store):
    ahead = (Ahead(168.0, 0.3, "Power/Battery", 0.75),)
    commit(
        store, "a", (1, 0, 0.3), present=PresentState(1, "{}", {"robot": "c", "design_hash": "x", "time": BEGIN}, ahead)
    )
    commit(store, "a", (2, 1, 0.1))
    assert worst(store, 168.0, 5).robots[0].first is None


@pytest.mark.parametrize(("text", "hours"), [("1 day", 24.0), ("24 h", 24.0), ("1 week", 168.0), ("30 day", 720.0)])
def test_horizons(text, hours):
    assert horizon_of(text) == hours


def test_another_horizon_is_refused_in_words():
    with pytest.raises(RobophmError, match="'1 day', '1 week' and '30 day'"):
        horizon_of("2 week")


def test_a_history_is_lowest_mean_and_highest_of_its_reports(store, monkeypatch):
    """Against plain numpy over the same spans, with pages of reports that cut through them."""
    monkeypatch.setattr("robophm.fleet.questions.AT_ONCE", 7)
    chance = np.random.default_rng(4).uniform(size=100).astype(np.float32).astype(float)
    for first in range(0, 100, 25):
        commit(store, "a", *((n + 1, n * 1.5, chance[n]) for n in range(first, first + 25)))
    whole = history(store, "a", None, None, 200).series
    at = COLUMNS.index("failure_within.168")
    assert (whole.width, len(whole.times)) == (0, 100)
    np.testing.assert_array_equal(whole.mean[:, at], chance)
    found = history(store, "a", None, None, 10).series
    times = np.array([BEGIN + round(n * 1.5 * MINUTE) for n in range(100)])
    span = times // found.width
    assert len(found.times) <= 10
    assert found.times.tolist() == [one * found.width for one in np.unique(span)]
    for place, one in enumerate(np.unique(span)):
        some = chance[span == one]
        assert (found.low[place, at], found.high[place, at]) == (some.min(), some.max())
        assert found.mean[place, at] == pytest.approx(some.mean(), rel=1e-12)
        assert found.number[place, at] == len(some)
    assert np.isnan(found.mean[:, 0]).all()
    window = history(store, "a", int(times[10]), int(times[20]), 200).series
    assert window.times.tolist() == times[10:20].tolist()
    assert len(history(store, "b", None, None, 10).series.times) == 0


def test_a_robot_that_is_not_there_is_said_with_what_is_near(store):
    with pytest.raises(RobophmError, match="no robot 'e'"):
        history(store, "e", None, None, 10)
