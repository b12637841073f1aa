"""Robots side by side: each answers as it does alone, and alone as closed forms say."""

import itertools
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.task import Knowledge
from robophm.health.fleet import Fleet
from robophm.health.future import Future
from robophm.health.outlooks import as_designed, nominal_outlook
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook

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
    one, other = (as_designed(Plant(parse(text))) for text in (PAIRS, MIXED))
    assert len(Fleet.of([one, as_designed(Plant(parse(PAIRS)))])) == 2  # each with a Plant of its own
    with pytest.raises(DesignError, match="'mixed' has another design than 'two pairs'"):
        Fleet.of([one, other])
    on_and_off = Future.of_steps("plan", [1.0, 2.0], [1.0, 0.0], *np.ones((2, 3, 2)))
    with pytest.raises(DesignError, match="steadily"):
        Fleet.of([replace(one, plan=on_and_off)])


@pytest.mark.parametrize("kinds", [2, 80])
def test_parts_that_are_alike(kinds):
    """Eighty equal modules of six parts, aged alike or each for itself: against the product of their closed forms."""
    module = """{components: {
      wheel: {life: {distribution: weibull, scale: 4e4 h, shape: 2}}, eye: {rate: 1e-4 /h, quantity: 2, required: 1},
      joint: {life: {distribution: weibull, scale: 9e3 h, shape: 1.5}, quantity: 3, required: 2}}}"""
    robot = parse(
        "\n".join(["{schema_version: 1, name: alike, modules: {", *(f"M{i}: {module}," for i in range(80)), "}}"])
    )
    plant = Plant(robot)
    assert len(robot.modes) == 240
    at = np.array([int(mode.path[1:].partition("/")[0]) % kinds for mode in robot.modes]) * 10.0
    outlook = nominal_outlook(plant, at)
    hours = np.array([0.0, 3.0, 500.0, 4000.0])
    works, failed = outlook.reliability_curve(robot.diagram, hours)
    expected = np.ones(4)
    for i in range(80):
        t = hours + i % kinds * 10.0
        wheel, eye, joint = np.exp(-((t / 4e4) ** 2)), np.exp(-1e-4 * t), np.exp(-((t / 9e3) ** 1.5))
        expected *= wheel * (1 - (1 - eye) ** 2) * (3 * joint**2 - 2 * joint**3)
    assert works == pytest.approx(expected, rel=1e-12)
    assert failed == pytest.approx(1 - expected, rel=1e-9, abs=1e-15)
    structure, modes, sums = plant.system(robot.diagram).by_kind(at)
    assert len(modes.modes) == (6 if kinds == 2 else len(robot.modes))
    each = np.unique(structure.leaves, return_index=True)[1]
    # wheels in a row, two eyes, three joints
    assert sums.weights[each].sum() == 80 + (2 + 2 if kinds == 2 else 80 * (2 + 3))
    assert (structure is plant.system(robot.diagram).structure) == (kinds == 80)


LIVES = {"a": (4000, 2.2), "b": (9000, 0.8), "c": (7000, 1.4), "d": (3000, None), "e": (6000, 3.7), "g": (8000, None),
         "h": (2500, 1.9)}  # fmt: skip
SHARED = """
schema_version: 1
name: shared
diagram:
  series:
    - a
    - k_of_n: {k: 2, of: [b, {parallel: [c, d]}, e]}
    - {parallel: [{series: [d, g]}, {series: [e, h]}]}
components:
"""


def works(s):
    return s["a"] and s["b"] + (s["c"] or s["d"]) + s["e"] >= 2 and ((s["d"] and s["g"]) or (s["e"] and s["h"]))


def test_hazard_rates_in_both_tails():
    """From F = 1e-30 to R = 1e-30 the hazard rate is good to 4e-15: against the sum over all states by mpmath."""
    robot = parse(SHARED + "".join(
        f"  {name}: {{life: {{distribution: weibull, scale: {scale} h, shape: {shape}}}}}\n" if shape
        else f"  {name}: {{rate: {1 / scale!r} /h}}\n"
        for name, (scale, shape) in LIVES.items()
    ))  # fmt: skip
    life = {mode.path: mode.life for mode in robot.modes}
    times = np.append(10 ** np.linspace(-13.4, 4.2, 60), np.linspace(1.6e4, 3.2e4, 20))
    found = Fleet.designed(Plant(robot), np.tile(times, (7, 1))).since_new(robot.diagram)
    reached = []
    for i, t in enumerate(mp.mpf(float(one)) for one in times):
        p, h = {}, {}
        for name, (_, shape) in LIVES.items():
            scale, power = (life[name].scale, life[name].shape) if shape else (1 / mp.mpf(life[name].rate), 1)
            p[name] = mp.exp(-((t / scale) ** power))
            h[name] = mp.mpf(power) / scale * (t / scale) ** (mp.mpf(power) - 1)
        R, F, f = mp.mpf(0), mp.mpf(0), mp.mpf(0)
        for bits in itertools.product((False, True), repeat=7):
            s = dict(zip(LIVES, bits, strict=True))
            probability = mp.fprod(p[name] if s[name] else 1 - p[name] for name in LIVES)
            R, F = (R + probability, F) if works(s) else (R, F + probability)
            f += sum(probability * h[one] for one in LIVES if works(s) and s[one] and not works(s | {one: False}))
        if R > 1e-30 and F > 1e-30:
            assert float(found.density[i] / found.works[i]) == pytest.approx(float(f / R), rel=4e-15)
            reached += [R, F]
    assert min(reached[::2]) < 1e-28
    assert min(reached[1::2]) < 1e-28


def test_memory_of_a_batch():
    """Twenty thousand robots of a hundred parts take less than 24 bytes per part and robot beyond what is given."""
    parts = "".join(f"  p{i}: {{life: {{distribution: weibull, scale: {1000 + i} h, shape: 2}}}}\n" for i in range(100))
    robot = parse(f"schema_version: 1\nname: batch\ncomponents:\n{parts}")
    age = np.random.default_rng(1).uniform(0, 1000, (100, 20_000))
    fleet = Fleet.designed(Plant(robot), age)
    fleet.ahead(robot.diagram, 1.0)
    for ask in (lambda: fleet.ahead(robot.diagram, 1.0), lambda: fleet.since_new(robot.diagram)):
        tracemalloc.start()
        ask()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 24 * age.size
