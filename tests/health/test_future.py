"""Futures: clocks and stresses along calendar time, and remaining life under them by direct integration."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from robophm.core.errors import DesignError
from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Leg, Plan, Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.future import Future
from robophm.health.ledger import Ledger
from robophm.health.mission import plan_future
from robophm.health.outlooks import FutureName, as_designed, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook

START = 1_700_000_000 * SECOND
HOT = {"temperature": {"topic": "/t", "field": "c", "unit": "degC", "max_age": "1e6 s", "range": [-40, 200]}}
Q10 = {"model": "q10", "reference_temperature": "25 degC"}
SHAPE_2 = {"distribution": "weibull", "scale": "100 h", "shape": 2}


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def exact(value: Any, rel: float = 1e-12) -> Any:
    return pytest.approx(float(value), rel=rel, abs=0)


def path(hours: list[float], operating: list[float], advance: list[list[float]], factor: list[list[float]]) -> Future:
    gone = np.array(advance, dtype=float)
    return Future.of_steps("path", hours, operating, gone, np.array(factor) * gone)


def check(outlook: Outlook, future: Future, survives: Callable[[mpf], mpf], ends: list[float], late: float) -> None:
    """Mean by quadrature between the knots, quantiles by the probability that they should have."""
    found = outlook.remaining_life(outlook.plant.robot.diagram, future)
    with mp.workdps(20):
        knots = sorted({mpf(0), *(mpf(end) for end in ends if end < late), mpf(late)})
        assert found.mean == exact(mp.quad(survives, knots), 1e-9)
        for q, time in ((0.05, found.early), (0.5, found.median), (0.95, found.late)):
            assert survives(mpf(time)) == exact(1 - q, 1e-10)


def periods(ends: list[float], count: int) -> list[float]:
    return [n * ends[-1] + end for n in range(count) for end in ends]


# What a path says of every clock.


def test_a_path_is_linear_between_its_knots_and_begins_anew() -> None:
    future = path([2.0, 1.0, 5.0], [2.0, 1.0, 0.0], [[2.0, 4.0, 0.0], [2.0, 1.0, 5.0]], [[1, 0.5, 1], [3, 2, 1]])
    whole, effective = np.array([6.0, 8.0]), np.array([4.0, 13.0])
    inside = {
        0.0: ([0.0, 0.0], [0.0, 0.0]),
        1.0: ([1.0, 1.0], [1.0, 3.0]),
        2.0: ([2.0, 2.0], [2.0, 6.0]),
        2.25: ([3.0, 2.25], [2.5, 6.5]),
        3.0: ([6.0, 3.0], [4.0, 8.0]),
        5.5: ([6.0, 5.5], [4.0, 10.5]),
    }
    for round_ in (0, 1, 2, 1000):
        for hours, (gone, aged) in inside.items():
            advance, stressed = future.at(np.array([round_ * 8.0 + hours]))
            assert advance[:, 0] == pytest.approx(round_ * whole + gone, rel=1e-14)
            assert stressed[:, 0] == pytest.approx(round_ * effective + aged, rel=1e-14)
    assert future.usage.tolist() == [2.0, exact(8 / 3)]
    assert future.factor.tolist() == [exact(2 / 3), exact(13 / 8)]


def test_a_path_of_equal_steps_is_steady() -> None:
    plant = Plant(robot({"a": {"rate": "1e-3 /h"}, "s": {"rate": "1e-3 /h", "clock": "calendar"}}))
    steady = Future.steady("steady", plant, np.array([3.0, 2.0]), np.array([1.0, 1.0]), 0.25)
    steps = path([1.0] * 4, [0.25] * 4, [[0.25] * 4, [1.0] * 4], [[3.0] * 4, [2.0] * 4])
    times = np.array([0.0, 1e-9, 0.3, 1.0, 3.999, 4.0, 17.3, 1e9])
    for one, other in zip(steady.at(times), steps.at(times), strict=True):
        assert one == pytest.approx(other, rel=1e-12)
    assert steady.usage.tolist() == pytest.approx(steps.usage.tolist())
    assert steady.factor.tolist() == pytest.approx(steps.factor.tolist())


def test_what_takes_no_time_is_there_at_once() -> None:
    """A start of the motor at the beginning of each day, one in its middle."""
    future = path([0.0, 12.0, 0.0, 12.0], [0.0, 12.0, 0.0, 0.0], [[1.0, 0.0, 2.0, 0.0]], [[1.0, 1.0, 1.0, 1.0]])
    advance, _ = future.at(np.array([0.0, 6.0, 11.999, 12.0, 23.0, 24.0, 36.0]))
    assert advance[0].tolist() == [1.0, 1.0, 1.0, 3.0, 3.0, 4.0, 6.0]


def test_a_path_goes_on_for_ever() -> None:
    future = path([1.0, 2.0], [1.0, 0.0], [[1.0, 0.0]], [[1.0, 1.0]])
    times = np.array([1e12, 1e100, 1e250])
    advance, effective = future.at(times)
    assert advance[0] == pytest.approx(times / 3, rel=1e-9)
    assert effective[0] == pytest.approx(times / 3, rel=1e-9)


# Remaining life under it.


def test_an_exponential_part_by_day_and_night() -> None:
    """Four times the rate by day for 8 h, off for 16 h: the mean is that of one day over 1 − S(day)."""
    outlook = as_designed(Plant(robot({"a": {"rate": "0.01 /h"}})))
    future = path([8.0, 16.0], [8.0, 0.0], [[8.0, 0.0]], [[4.0, 1.0]])
    found = outlook.remaining_life(outlook.plant.robot.diagram, future)
    rate = 4 * mpf(0.01)
    day = mp.exp(-8 * rate)
    assert found.mean == exact(((1 - day) / rate + 16 * day) / (1 - day), 1e-9)
    for q, time in ((0.05, found.early), (0.5, found.median), (0.95, found.late)):
        worked = -mp.log(1 - mpf(q)) / rate
        whole = mp.floor(worked / 8)
        assert time == exact(24 * whole + worked - 8 * whole, 1e-10)


@pytest.mark.parametrize("rate", [0.05, 1.0, 10.0])
@pytest.mark.parametrize(("on", "off"), [(1.0, 167.0), (8.0, 16.0), (0.01, 23.99)])
def test_a_robot_that_is_rarely_on(rate: float, on: float, off: float) -> None:
    """Survival is a staircase with long treads; the mean has them all."""
    outlook = as_designed(Plant(robot({"a": {"rate": f"{rate} /h"}})))
    found = outlook.remaining_life(outlook.plant.robot.diagram, path([on, off], [on, 0.0], [[on, 0.0]], [[1.0, 1.0]]))
    fails = -mp.expm1(-mpf(rate) * mpf(on))
    assert found.mean == exact((fails / mpf(rate) + mpf(off) * (1 - fails)) / fails, 1e-6)


@pytest.mark.parametrize("initial", [0.0, 60.0])
def test_a_weibull_part_by_age_along_a_path(initial: float) -> None:
    part = {"life": SHAPE_2, "initial_exposure": f"{initial} h"}
    outlook = as_designed(Plant(robot({"a": part})))
    hours, factor = [3.0, 5.0, 16.0], [6.0, 2.0, 0.5]
    future = path(hours, [3.0, 5.0, 16.0], [[3.0, 5.0, 16.0]], [factor])

    def effective(t: mpf) -> mpf:
        whole, rest = divmod(t, 24)
        return mpf(initial) + 36 * whole + min(rest, 3) * 6 + max(min(rest - 3, 5), 0) * 2 + max(rest - 8, 0) / 2

    def survives(t: mpf) -> mpf:
        return mp.exp((mpf(initial) / 100) ** 2 - (effective(t) / 100) ** 2)

    check(outlook, future, survives, periods([3.0, 8.0, 24.0], 40), 700.0)


def test_a_pair_on_two_clocks_along_a_path() -> None:
    """One drives by day, the other ages by the calendar; either will do."""
    parts = {
        "wheel": {"life": {"distribution": "weibull", "scale": "40 km", "shape": 3}, "clock": "kilometres"},
        "seal": {"rate": "0.01 /h", "clock": "calendar", "initial_exposure": "30 h"},
    }
    outlook = as_designed(Plant(robot(parts, diagram={"parallel": ["wheel", "seal"]}, usage={"kilometres": "1 km/h"})))
    rows = {mode.path: i for i, mode in enumerate(outlook.plant.robot.modes)}
    advance = [[0.0] * 2, [0.0] * 2]
    advance[rows["wheel"]], advance[rows["seal"]] = [6.0, 0.0], [10.0, 14.0]
    factor = [[1.0] * 2, [1.0] * 2]
    factor[rows["seal"]] = [3.0, 1.0]
    future = path([10.0, 14.0], [10.0, 0.0], advance, factor)
    lost = -mp.expm1(-mpf(0.3))  # the seal by now; the wheel is new

    def survives(t: mpf) -> mpf:
        whole, rest = divmod(t, 24)
        driven = 6 * whole + min(rest, 10) * mpf("0.6")
        aged = 44 * whole + 3 * min(rest, 10) + max(rest - 10, 0)
        wheel = -mp.expm1(-((driven / 40) ** 3))
        seal = lost + (1 - lost) * -mp.expm1(-mpf(0.01) * aged)
        return 1 - wheel * seal

    check(outlook, future, survives, periods([10.0, 24.0], 60), 1440.0)


def test_a_hazard_that_stress_weighs_along_a_path() -> None:
    """h₀ = 2a/100², five times as high in the first half of each round."""
    outlook = as_designed(Plant(robot({"a": {"life": SHAPE_2, "scaling": "hazard"}})))
    future = path([20.0, 20.0], [20.0, 20.0], [[20.0, 20.0]], [[5.0, 1.0]])

    def hazard(t: mpf) -> mpf:
        whole, rest = divmod(t, 40)
        done = sum(
            5 * ((40 * k + 20) ** 2 - (40 * k) ** 2) + (40 * k + 40) ** 2 - (40 * k + 20) ** 2
            for k in range(int(whole))
        )
        start = 40 * whole
        middle = start + min(rest, 20)
        return (done + 5 * (middle**2 - start**2) + t**2 * (rest > 20) - middle**2 * (rest > 20)) / 100**2

    check(outlook, future, lambda t: mp.exp(-hazard(t)), periods([20.0, 40.0], 20), 480.0)


def test_a_hazard_that_stress_weighs_for_many_rounds() -> None:
    """Beyond the changes that are followed one by one the mean stress holds: an error that fades with age."""
    outlook = as_designed(Plant(robot({"a": {"life": SHAPE_2, "scaling": "hazard"}})))
    future = path([0.02, 0.02], [0.02, 0.02], [[0.02, 0.02]], [[5.0, 1.0]])
    curve = outlook.curve(outlook.plant.robot.diagram, future)
    rounds = np.array([1, 10, 100, 1000, 3000])
    fails, _ = curve(0.04 * rounds)
    for n, failed in zip(rounds.tolist(), fails, strict=True):
        gathered = sum(5 * (4 * k + 1) + 4 * k + 3 for k in range(n)) * (mpf("0.02") / 100) ** 2
        assert failed == exact(-mp.expm1(-gathered), 1e-12 if n <= 100 else 2e-3)


def test_a_clock_that_rests_as_a_round_begins_never_goes_back() -> None:
    """k·x + x may round to more than (k + 1)·x, so that the rest that follows would seem to make a part younger."""
    plant = Plant(robot({"a": {"life": SHAPE_2, "scaling": "hazard"}, "b": {"life": SHAPE_2}}))
    future = path([0.7, 0.1], [0.7, 0.1], [[0.7, 0.1], [0.0, 0.1]], [[3.0, 1.0], [3.0, 1.0]])
    assert any(k * 0.1 + 0.1 > (k + 1) * 0.1 for k in range(100))
    rounds = np.array([1, 10, 100])
    fails, _ = as_designed(plant).curve(plant.robot.diagram, future)(0.8 * rounds)
    for n, failed in zip(rounds.tolist(), fails, strict=True):
        weighed = sum(3 * ((8 * k + 7) ** 2 - (8 * k) ** 2) + (8 * k + 8) ** 2 - (8 * k + 7) ** 2 for k in range(n))
        assert failed == exact(-mp.expm1(-(mpf(weighed) + n**2) / 1000**2), 1e-11)


# The futures of an outlook: nominal, last, recent.


def lived(design: Robot, future: FutureName, minutes: list[tuple[int, float]]) -> Outlook:
    exposure, ledger, now = ExposureIntegrator(design), Ledger.new(design), START
    ledger.started = now
    for length, celsius in minutes:
        for _ in range(length):
            now += 60 * SECOND
            exposure.integrate(ledger, [Sample(now - 60 * SECOND, "/t.c", celsius)], now)
    assert now - START < HOUR
    return outlooks(Plant(design), exposure, ledger, future=future)["sensor_based"]


@pytest.mark.parametrize(("future", "factor"), [("nominal", 1), ("last", 8), ("recent", mpf("5.6"))])
@pytest.mark.parametrize("share", [1.0, 0.25])
@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_nominal_last_and_recent(future: FutureName, factor: Any, share: float, scaling: str) -> None:
    """25 °C long ago, then 4 min at 35 and 6 min at 55 °C: now 8 times, of late (4·2 + 6·8)/10 = 5.6 times the rate."""
    past = [(20, 25.0), (4, 35.0), (6, 55.0)]
    usage = {"operating": share}
    one = robot({"a": {"rate": "0.01 /h", "acceleration": Q10}}, signals=HOT, usage=usage)
    found = lived(one, future, past).remaining_life(one.diagram)
    assert found.mean == exact(1 / (mpf(0.01) * factor * share), 1e-10)
    assert found.median == exact(mp.log(2) / (mpf(0.01) * factor * share), 1e-10)
    wear = robot({"a": {"life": SHAPE_2, "acceleration": Q10, "scaling": scaling}}, signals=HOT, usage=usage)
    found = lived(wear, future, past).remaining_life(wear.diagram)
    clock, age = mpf("0.5"), (20 + 4 * 2 + 6 * 8) / mpf(60)
    for q, time in ((0.05, found.early), (0.5, found.median), (0.95, found.late)):
        ahead = share * mpf(time)
        more = (age + factor * ahead) ** 2 - age**2 if scaling == "age" else factor * ((clock + ahead) ** 2 - clock**2)
        assert mp.exp(-more / 100**2) == exact(1 - q, 1e-11)


# A plan of tasks.


@pytest.mark.full
def test_a_plan_begun_anew_every_day() -> None:
    """Two hours hot, one hour idle in which the motor ages by its duty; the calendar goes on."""
    parts = {
        "motor": {"rate": "0.02 /h", "acceleration": Q10, "duty": 0.5},
        "lamp": {"rate": "0.01 /h"},
        "seal": {"rate": "0.001 /h", "clock": "calendar"},
    }
    design = robot(parts, functions={"drive": "motor", "see": "lamp"})
    outlook = outlooks(Plant(design), ExposureIntegrator(design), Ledger.new(design))["sensor_based"]
    task = Task((Leg(2.0, functions=("drive", "see"), stresses={"temperature": 45.0}), Leg(1.0, functions=("see",))))
    future = plan_future(outlook, Plan((task,), every=24.0))

    def survives(t: mpf) -> mpf:
        whole, rest = divmod(t, 24)
        motor = mpf("8.5") * whole + 4 * min(rest, 2) + max(min(rest - 2, 1), 0) / 2
        lamp = 3 * whole + min(rest, 3)
        return mp.exp(-mpf(0.02) * motor - mpf(0.01) * lamp - mpf(0.001) * t)

    check(outlook, future, survives, periods([2.0, 3.0, 24.0], 130), 24.0 * 130)
    assert (future.hours[-1], future.operating[-1]) == (24.0, 3.0)


def test_a_plan_without_a_period_goes_on_as_the_operating_share_allows() -> None:
    design = robot({"a": {"rate": "0.01 /h"}}, usage={"operating": 0.25})
    outlook = as_designed(Plant(design))
    future = plan_future(outlook, Plan((Task((Leg(2.0),)), Task((Leg(1.0),)))))
    assert (future.hours[-1], future.operating[-1]) == (12.0, 3.0)
    mean = outlook.remaining_life(design.diagram, future).mean
    round_ = mp.exp(-3 * mpf(0.01))
    assert mean == exact(((1 - round_) / mpf(0.01) + 9 * round_) / (1 - round_), 1e-6)


def test_a_plan_that_takes_no_time_is_refused() -> None:
    outlook = as_designed(
        Plant(robot({"a": {"rate": "0.01 /cycle", "clock": "cycles"}}, usage={"cycles": "1 cycle/h"}))
    )
    at_once = Task((Leg(0.0, cycles=10.0),))
    with pytest.raises(DesignError, match="tasks that take no time cannot go on for ever"):
        plan_future(outlook, Plan((at_once,)))
    future = plan_future(outlook, Plan((at_once,), every=24.0))  # ten cycles at the start of every day
    assert future.at(np.array([0.0, 23.0, 24.0, 50.0]))[0][0].tolist() == [10.0, 10.0, 20.0, 30.0]


def test_many_times_in_turns_are_as_in_one(monkeypatch: pytest.MonkeyPatch) -> None:
    design = robot({"a": {"life": SHAPE_2, "acceleration": Q10, "scaling": "hazard"}, "b": {"rate": "0.01 /h"}})
    outlook = as_designed(Plant(design))
    future = path([1.0, 3.0], [1.0, 3.0], [[1.0, 3.0], [1.0, 3.0]], [[4.0, 1.0], [1.0, 1.0]])
    whole = outlook.remaining_life(design.diagram, future)
    monkeypatch.setattr("robophm.health.prognosis._IN_TURN", 14)
    assert outlook.remaining_life(design.diagram, future) == whole


def test_what_never_fails_under_a_future_lives_for_ever() -> None:
    design = robot({"a": {"rate": "0.01 /km", "clock": "kilometres"}}, usage={"kilometres": "1 km/h"})
    found = as_designed(Plant(design)).remaining_life(design.diagram, path([1.0], [1.0], [[0.0]], [[1.0]]))
    assert (found.mean, found.median, found.early, found.late) == (math.inf,) * 4


def test_the_pace_of_a_mode_is_of_the_clock_that_its_life_counts() -> None:
    """Half a day of operation at 3 km/h and twice the stress: of a life whose hazard is scaled stress says nothing."""
    parts = {"wheel": {"rate": "1e-5 /km", "clock": "kilometres"}, "seal": {"scaling": "hazard", "life": SHAPE_2}}
    plant = Plant(robot(parts, usage={"operating": 0.25, "kilometres": "3 km/h"}))
    future = Future.steady("f", plant, np.full(2, 2.0), plant.usage, 0.5)
    assert future.pace(plant) == pytest.approx([2.0 * 0.5 * 3.0, 0.5])
    assert as_designed(plant).future.pace(plant) == pytest.approx([0.25 * 3.0, 0.25])
