"""Availability of robots that are repaired, against Markov chains over all states of all parts, and by means alone."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

import robophm
from robophm.core.errors import DesignError, RobophmError
from robophm.design.file import parse
from robophm.design.task import Knowledge

HOURS = 2000.0


def design(text: str) -> robophm.Robot:
    return parse("schema_version: 1\nname: r\n" + text, "r.yaml", Path())


def chain(parts: list[tuple[float, float]], works) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The generator over all states of parts (rate, repair), which states work, and how fast each fails the system."""
    states = list(itertools.product((True, False), repeat=len(parts)))
    place = {state: i for i, state in enumerate(states)}
    rates = np.zeros((len(states), len(states)))
    for state, (i, (rate, repair)) in itertools.product(states, enumerate(parts)):
        other = (*state[:i], not state[i], *state[i + 1 :])
        rates[place[state], place[other]] = rate if state[i] else 1 / repair
    up = np.array([works(state) for state in states])
    fails = np.where(up, rates @ ~up, 0.0)
    return rates - np.diag(rates.sum(axis=1)), up, fails


def expected(generator: np.ndarray, up: np.ndarray, fails: np.ndarray, hours: float) -> tuple[float, float, float]:
    """P(works) at the end, hours down and failures until then: the integrals as two more states of the chain."""
    n = len(up)
    larger = np.zeros((n + 2, n + 2))
    larger[:n, :n], larger[:n, n], larger[:n, n + 1] = generator, ~up, fails
    end = expm(larger * hours)[0]
    return float(end[:n] @ up), float(end[n]), float(end[n + 1])


def settled(generator: np.ndarray, up: np.ndarray, fails: np.ndarray) -> tuple[float, float]:
    """P(works) and failures in an hour in the long run."""
    equations = np.vstack((generator.T, np.ones(len(up))))
    share = np.linalg.lstsq(equations, np.append(np.zeros(len(up)), 1.0), rcond=None)[0]
    return float(share @ up), float(share @ fails)


def diagrams(drawn: np.random.Generator, names: list[str]) -> tuple[str, object]:
    """A random diagram over some names, some of them twice, and whether it works in a state."""
    if len(names) == 1:
        return names[0], lambda state, i=names[0]: state[i]
    cut = int(drawn.integers(1, len(names)))
    (one, first), (other, second) = diagrams(drawn, names[:cut]), diagrams(drawn, names[cut:])
    if drawn.random() < 0.4:
        shared = names[int(drawn.integers(cut))]
        return (f"{{parallel: [{one}, {{series: [{other}, {shared}]}}]}}",
                lambda state: first(state) or (second(state) and state[shared]))  # fmt: skip
    if drawn.random() < 0.5:
        return f"{{series: [{one}, {other}]}}", lambda state: first(state) and second(state)
    return f"{{parallel: [{one}, {other}]}}", lambda state: first(state) or second(state)


@pytest.mark.parametrize("seed", range(8))
def test_random_diagrams_are_as_the_chain_over_all_states(seed: int) -> None:
    drawn = np.random.default_rng(seed)
    names = [f"p{i}" for i in range(int(drawn.integers(2, 6)))]
    parts = [(float(10 ** drawn.uniform(-4, -2)), float(10 ** drawn.uniform(0, 2.5))) for _ in names]
    wiring, works = diagrams(drawn, names)
    text = "components:\n" + "".join(
        f"  {name}: {{rate: {rate!r} /h, repair: {repair!r} h}}\n"
        for name, (rate, repair) in zip(names, parts, strict=True)
    )
    found = robophm.availability(design(f"{text}diagram: {wiring}\n"), hours=HOURS)
    system = chain(parts, lambda state: works(dict(zip(names, state, strict=True))))
    end, down, failures = expected(*system, HOURS)
    assert found.at_its_end == pytest.approx(end, rel=1e-9)
    assert found.hours_down == pytest.approx(down, rel=1e-6)
    assert found.failures == pytest.approx(failures, rel=1e-6)
    up, frequency = settled(*system)
    assert found.long_run.availability == pytest.approx(up, rel=1e-9)
    assert found.long_run.frequency == pytest.approx(frequency, rel=1e-6)
    assert found.long_run.time_up == pytest.approx(up / frequency, rel=1e-6)
    assert found.long_run.time_down == pytest.approx((1 - up) / frequency, rel=1e-4)
    assert sum(one.causes for one in found.parts) == pytest.approx(1)


def test_equal_parts_are_each_repaired() -> None:
    """Three in series, and two of three: the textbook's A = 1/(1 + λ·MTTR) each, to its powers."""
    found = robophm.availability(design("repair: 10 h\ncomponents:\n  a: {rate: 1e-3 /h, quantity: 3}\n"))
    one = 1 / 1.01
    assert found.long_run.availability == pytest.approx(one**3, rel=1e-12)
    assert found.long_run.frequency == pytest.approx(3e-3 * one**3, rel=1e-12)
    found = robophm.availability(design("repair: 10 h\ncomponents:\n  a: {rate: 1e-3 /h, quantity: 3, required: 2}\n"))
    assert found.long_run.availability == pytest.approx(one**3 + 3 * one**2 * (1 - one), rel=1e-12)
    assert found.long_run.frequency == pytest.approx(6e-3 * one**2 * (1 - one), rel=1e-12)


def test_lives_that_age_count_by_their_means_in_the_long_run() -> None:
    text = "components:\n  a: {mtbf: 800 h, life: {distribution: weibull, shape: 3}, repair: 20 h}\n"
    found = robophm.availability(design("usage: 12 h/day\n" + text), hours=20_000)
    mean = 1600.0  # by the calendar: it works half of the time
    assert found.long_run.availability == pytest.approx(mean / (mean + 20), rel=1e-9)
    assert found.at_its_end == pytest.approx(mean / (mean + 20), rel=1e-5)
    assert found.failures == pytest.approx(20_000 / 1620, rel=0.05)  # less what none of the first has had behind it


def test_a_used_part_fails_by_its_age_until_it_is_put_in_new() -> None:
    worn = "components:\n  a: {mtbf: 800 h, life: {distribution: weibull, shape: 4}, repair: 20 h%s}\n"
    new, used = (robophm.availability(design(worn % text), hours=200) for text in ("", ", initial_exposure: 700 h"))
    scale = 800 / math.gamma(1.25)
    first = 1 - math.exp((700 / scale) ** 4 - (900 / scale) ** 4)  # hardly any fails twice within 200 h
    assert used.failures == pytest.approx(first, rel=2e-3)
    assert new.failures == pytest.approx(-math.expm1(-((200 / scale) ** 4)), rel=1e-3)
    assert used.long_run == new.long_run


def test_without_repair_it_stays_failed() -> None:
    found = robophm.availability(
        design("components:\n  a: {rate: 1e-3 /h, repair: 5 h}\n  b: {rate: 1e-5 /h, repair: none}\n"), hours=1000
    )
    assert found.never_repaired == ("b",)
    assert (found.long_run.availability, found.long_run.frequency) == (0.0, 0.0)
    assert found.long_run.time_down == math.inf
    one = expected(*chain([(1e-3, 5.0), (1e-5, 1e300)], all), 1000.0)
    assert (found.at_its_end, found.hours_down, found.failures) == pytest.approx(one, rel=1e-6)


def test_what_never_fails_is_always_there() -> None:
    found = robophm.availability(design("components:\n  a: {rate: unknown, repair: 5 h}\n"))
    assert (found.long_run.availability, found.long_run.time_between_failures) == (1.0, math.inf)
    assert found.failures == found.hours_down == 0
    assert found.unknown is not None


def test_what_is_known_to_have_failed_is_being_repaired() -> None:
    robot = design("components:\n  a: {rate: 1e-3 /h, repair: 50 h}\n  b: {rate: 1e-3 /h, repair: 50 h}\n")
    report = robophm.Monitor(robot).report(knowledge=Knowledge(frozenset({"a"})))
    found = robophm.availability(report, hours=300)
    generator, up, fails = chain([(1e-3, 50.0)] * 2, all)
    n = len(up)
    larger = np.zeros((n + 2, n + 2))
    larger[:n, :n], larger[:n, n], larger[:n, n + 1] = generator, ~up, fails
    end = expm(larger * 300.0)[2]  # a down, b works
    assert found.hours_down == pytest.approx(end[n], rel=1e-6)
    assert found.failures == pytest.approx(end[n + 1], rel=1e-6)


def test_common_causes_take_the_longest_repair() -> None:
    robot = design(
        "components:\n  a: {rate: 1e-3 /h, repair: 5 h}\n  b: {rate: 1e-3 /h, repair: 30 h}\n"
        "diagram: {parallel: [a, b]}\ncommon_causes:\n  flood: {of: [a, b], beta: 0.1}\n"
    )
    found = robophm.availability(robot)
    parts = [(9e-4, 5.0), (9e-4, 30.0), (1e-4, 30.0)]
    up, frequency = settled(*chain(parts, lambda state: (state[0] or state[1]) and state[2]))
    assert found.long_run.availability == pytest.approx(up, rel=1e-9)
    assert found.long_run.frequency == pytest.approx(frequency, rel=1e-6)


@pytest.mark.parametrize(
    ("repair", "said"),
    [
        ("4", "components/a/repair"),
        ("-4 h", "components/a/repair: -4 h is not a time to repair"),
        ("0 h", "is not a time to repair"),
        ("never", "expected a time, e.g. 4 h, or the word none"),
        ("4 km", "components/a/repair"),
        ("1e9 year", "at most 30 years"),
        (".inf", "components/a/repair"),
    ],
)
def test_times_that_are_none_are_refused(repair: str, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        design(f"components:\n  a: {{rate: 1e-3 /h, repair: {repair}}}\n")


@pytest.mark.parametrize("hours", [0, -1, math.nan, math.inf, 1e12])
def test_hours_that_are_none_are_refused(hours: float) -> None:
    with pytest.raises(RobophmError, match="hours"):
        robophm.availability(design("components:\n  a: {rate: 1e-3 /h}\n"), hours=hours)
