"""When parts are due: closed forms of Weibull lives, what does not wear, what is not known, wear and alarms."""

from __future__ import annotations

import math

import pytest

from robophm.core.errors import RobophmError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.health.ledger import Ledger
from robophm.health.outlooks import as_designed
from robophm.health.part_due import dues, rises
from robophm.health.plant import Plant
from robophm.health.service import ServiceNote, take_note
from robophm.health.worn import SeenWear, with_wear
from robophm.life.exponential import Exponential
from robophm.life.weibull import Weibull
from robophm.monitoring.monitor import Monitor

DESIGN = """
schema_version: 1
name: R
usage: {operating: 50 %}
components:
  bearing: {quantity: 2, rate: 100 FPMH, life: {distribution: weibull, shape: 3}, initial_exposure: 2000 h}
  board: {rate: 10 FPMH}
  infant: {rate: 20 FPMH, life: {distribution: weibull, shape: 0.7}}
  puzzle: {rate: unknown}
  arm: {failure_modes: {gear: {rate: 50 FPMH, life: {distribution: weibull, shape: 2}}, wire: {rate: 5 FPMH}}}
"""
BEGIN = 1_795_000_000 * SECOND


@pytest.fixture(scope="module")
def robot():
    return parse(DESIGN)


def by_part(found):
    return {one.part: one for one in found.parts}


def test_a_part_that_wears_is_due_when_one_of_its_equals_fails_with_the_chance_taken(robot):
    """Half of the time it is on: H(a) = (a/η)³ with η = 10⁴/Γ(4/3), from an age of 2000 h."""
    eta = 1e4 / math.gamma(4 / 3)

    def until(share):
        return 2 * (eta * ((2000 / eta) ** 3 - math.log1p(-share) / 2) ** (1 / 3) - 2000)

    one = by_part(dues(as_designed(Plant(robot)), risk=0.02))["bearing"]
    assert (one.state, one.quantity) == ("ahead", 2)
    assert one.due == pytest.approx(until(0.02), rel=1e-9)
    assert [one.early, one.median, one.late] == [pytest.approx(until(p), rel=1e-9) for p in (0.05, 0.5, 0.95)]
    half = eta * math.log(2) ** (1 / 3)
    assert one.why == f"it wears out: it has aged 2000 h, and half of such parts fail by {half:.4g} h"


def test_what_does_not_wear_is_useless_to_replace_and_what_is_unknown_is_said(robot):
    found = dues(as_designed(Plant(robot)))
    parts = by_part(found)
    assert [one.state for one in found.parts] == ["ahead", "ahead", "unknown", "useless", "useless"]
    for name in ("board", "infant"):
        assert (parts[name].state, parts[name].due) == ("useless", None)
        assert "a new one would fail as soon" in parts[name].why
    assert parts["board"].median == pytest.approx(2 * math.log(2) / 10e-6, rel=1e-9)
    assert (parts["puzzle"].state, parts["puzzle"].due, parts["puzzle"].median) == ("unknown", None, math.inf)
    assert parts["arm"].why.endswith("(its failure mode gear)")


def test_a_part_that_was_replaced_is_due_later_and_its_service_is_known(robot):
    monitor = Monitor(robot, period=60.0)
    for minute in range(0, 100 * 60, 5):
        monitor.observe(Sample(BEGIN + minute * HOUR // 60, CLOCK, 0.0))
    before = by_part(dues(outlook(monitor)))["bearing"]
    take_note(robot, monitor.ledger, ServiceNote("bearing", by="Ada"))
    after = by_part(dues(outlook(monitor), monitor.ledger))["bearing"]
    assert before.served is None
    assert after.served is not None
    assert after.served.by == "Ada"
    assert after.due > before.due + 1000


def outlook(monitor):
    return monitor.report(remaining_life=False).outlooks["sensor_based"]


def test_an_alarm_and_wear_at_its_limit_are_due_now(robot):
    new = as_designed(Plant(robot))
    found = dues(new, alarms={"arm/gear": "its teeth are gone"})
    assert (found.parts[0].part, found.parts[0].due, found.parts[0].why) == ("arm", 0.0, "its teeth are gone")
    seen = SeenWear("bearing", "bearing", "mean of /bearing.play", "reached", "h", 9, 1.0, 1.2)
    first = dues(with_wear(new, [seen]), wear=[seen]).parts[0]
    assert (first.part, first.due, first.state) == ("bearing", 0.0, "now")
    assert first.why == "its wear is at the limit: mean of /bearing.play has reached 1: it counts as failed"


def test_a_part_whose_clock_stands_is_not_due():
    """By its usage the robot never lifts."""
    robot = parse("""
schema_version: 1
name: R
usage: {cycles: 0 cycle/h}
components: {winch: {rate: 1e-4 /cycle, life: {distribution: weibull, shape: 2}, clock: cycles}}
""")
    (one,) = dues(as_designed(Plant(robot))).parts
    assert (one.state, one.due, one.median) == ("still", None, math.inf)


@pytest.mark.parametrize("risk", [0, -1, 0.6, math.nan])
def test_a_chance_that_is_none_is_refused(robot, risk):
    with pytest.raises(RobophmError, match="risk"):
        dues(as_designed(Plant(robot)), risk=risk)


def test_whether_a_hazard_rises():
    assert not rises(Exponential(1e-3))
    assert not rises(Weibull(1000.0, 1.0))
    assert not rises(Weibull(1000.0, 0.5))
    assert rises(Weibull(1000.0, 1.01))


def test_a_new_ledger_is_as_designed(robot):
    monitor = Monitor(robot, Ledger.new(robot))
    new, designed = (by_part(dues(one))["bearing"] for one in (outlook(monitor), as_designed(Plant(robot))))
    assert new.median == pytest.approx(designed.median, rel=1e-12)


def test_of_many_parts_those_that_wear_come_first(monkeypatch):
    monkeypatch.setattr("robophm.health.part_due.MOST", 1)
    robot = parse("""
schema_version: 1
name: R
components: {hot: {rate: 1e-3 /h}, old: {rate: 1e-6 /h, life: {distribution: weibull, shape: 2}}}
""")
    found = dues(as_designed(Plant(robot)))
    assert ([one.part for one in found.parts], found.others) == (["old"], 1)
