"""Robots side by side: each answers as it does alone, and alone as closed forms say."""

from dataclasses import replace

import numpy as np
import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.task import Knowledge
from robophm.health.fleet import Fleet
from robophm.health.future import Future
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook, as_designed, nominal_outlook

PAIRS = """
schema_version: 1
name: two pairs
diagram: {series: [brain, {parallel: [left, right]}]}
components:
  brain: {rate: 1e-4 /h, monitored: true}
  left: {rate: 1e-3 /h, monitored: true}
  right: {rate: 1e-3 /h, monitored: true}
"""
MIXED = """
schema_version: 1
name: mixed
usage: {operating: 0.3333333}
diagram:
  series:
    - brain
    - k_of_n: {k: 2, of: [wheel, {parallel: [motor, spare]}, arm]}
    - {parallel: [{series: [spare, lamp]}, {series: [arm, screen]}]}
components:
  brain: {rate: 2e-5 /h, monitored: true}
  wheel: {life: {distribution: weibull, scale: 4000 h, shape: 2.2}}
  motor: {life: {distribution: weibull, scale: 9000 h, shape: 0.8}, quantity: 2}
  spare: {life: {distribution: lognormal, log_mean: 8.0, log_deviation: 1.1}, monitored: true}
  arm: {life: {distribution: gamma, scale: 900 h, shape: 3.0}}
  lamp: {rate: 4e-4 /h}
  screen: {life: {distribution: weibull, scale: 7000 h, shape: 1.4}}
"""
STANDBY = """
schema_version: 1
name: standby
diagram: {series: [brain, {standby: {of: [first, second]}}]}
components:
  brain: {rate: 2e-5 /h}
  first: {life: {distribution: weibull, scale: 4000 h, shape: 1.8}}
  second: {life: {distribution: weibull, scale: 5000 h, shape: 1.5}}
"""
KNOWN = [Knowledge(), Knowledge(failed=frozenset({"wheel"})), Knowledge(working=frozenset({"lamp", "screen"}))]


def outlooks(text: str, count: int, known: list[Knowledge]) -> list[Outlook]:
    """As if lived: any ages, stresses, hazards gathered, and things known."""
    plant = Plant(parse(text))
    rng, found = np.random.default_rng(count), []
    modes = len(plant.robot.modes)
    for robot in range(count):
        alone = nominal_outlook(plant, rng.uniform(0, 3000, modes), known[robot % len(known)])
        factor, usage = rng.uniform(0.5, 3.0, (2, modes))
        found.append(
            replace(
                alone,
                cumulative_hazard=alone.cumulative_hazard * rng.uniform(0.8, 1.5),
                unseen_hazard=alone.unseen_hazard * rng.uniform(0.3, 0.8),
                factor_now=factor,
                future=Future.steady("recent", plant, factor, usage, 0.4),
            )
        )
    return found


@pytest.mark.parametrize("text", [MIXED, STANDBY], ids=["mixed", "standby"])
def test_each_as_alone(text, monkeypatch):
    monkeypatch.setattr("robophm.health.fleet.AT_ONCE", 21)  # three robots take turns
    every = outlooks(text, 7, KNOWN if text is MIXED else KNOWN[:1])
    diagram, fleet = every[0].plant.robot.diagram, Fleet.of(every)
    new, rate = fleet.since_new(diagram), fleet.hazard_rate(diagram)
    hours = np.linspace(1.0, 900.0, 7)
    fails, survives = fleet.ahead(diagram, hours)
    life = fleet.remaining_life(diagram)
    assert len(fleet) == len(new.works) == len(rate) == len(fails) == 7
    for i, alone in enumerate(every):
        state = alone.survival(diagram)
        assert (new.works[i], new.failed[i]) == pytest.approx((state.works, state.failed), rel=1e-13)
        assert rate[i] == pytest.approx(alone.hazard_rate(diagram), rel=1e-13)
        curve = alone.curve(diagram)(hours[i : i + 1])
        assert (fails[i], survives[i]) == pytest.approx((curve[0][0], curve[1][0]), rel=1e-13)
        expected = alone.remaining_life(diagram)
        assert life[:, i] == pytest.approx([expected.early, expected.median, expected.late], rel=1e-11)


def test_closed_forms():
    """A brain and a pair, in a day of twelve hours: by hand."""
    robot = parse(PAIRS + "usage: {operating: 0.5}\n")
    t, brain, one = np.array([1.0, 500.0, 1e4]), 1e-4, 1e-3
    plant = Plant(robot)
    fleet = Fleet.designed(plant, np.tile(t, (3, 1)))
    pair = 2 * np.exp(-one * t) - np.exp(-2 * one * t)
    state = fleet.since_new(robot.diagram)
    assert state.works == pytest.approx(np.exp(-brain * t) * pair, rel=1e-14)
    slope = 2 * one * (np.exp(-one * t) - np.exp(-2 * one * t))
    assert state.density == pytest.approx(np.exp(-brain * t) * (brain * pair + slope), rel=1e-12)
    assert fleet.hazard_rate(robot.diagram) == pytest.approx(np.full(3, brain), rel=1e-14)  # all are seen to work
    fails, survives = fleet.ahead(robot.diagram, 2 * t)  # as many operating hours as t, whatever the age: no part ages
    assert survives == pytest.approx(np.exp(-brain * t) * pair, rel=1e-14)
    assert fails == pytest.approx(1 - survives, rel=1e-10)
    median = fleet.remaining_life(robot.diagram, [0.5])
    works = np.exp(-brain * median / 2) * (2 * np.exp(-one * median / 2) - np.exp(-one * median))
    assert works == pytest.approx(np.full((1, 3), 0.5), rel=1e-11)


def test_what_has_failed_and_what_never_does():
    robot = parse(PAIRS)
    plant = Plant(robot)
    gone = as_designed(plant, Knowledge(failed=frozenset({"brain"})))
    still = replace(gone, knowledge=Knowledge(), future=Future.steady("off", plant, np.ones(3), np.zeros(3), 1.0))
    fleet = Fleet.of([gone, still])
    assert fleet.hazard_rate(robot.diagram).tolist() == [np.inf, pytest.approx(1e-4)]
    assert fleet.ahead(robot.diagram, 10.0)[1].tolist() == [0.0, 1.0]
    assert fleet.remaining_life(robot.diagram).tolist() == [[0.0, np.inf]] * 3


def test_robots_of_two_designs_are_no_fleet():
    one, other = (as_designed(Plant(parse(PAIRS))) for _ in range(2))
    with pytest.raises(DesignError, match="one design"):
        Fleet.of([one, other])
    on_and_off = Future.of_steps("plan", [1.0, 2.0], [1.0, 0.0], *np.ones((2, 3, 2)))
    with pytest.raises(DesignError, match="steadily"):
        Fleet.of([replace(one, plan=on_and_off)])
