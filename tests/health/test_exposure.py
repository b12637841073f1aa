"""Exposure against closed forms."""

from __future__ import annotations

import gc
import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.robot import Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.sample_stretch import SampleStretch

from .exposures import (
    ALWAYS_ON,
    HOURS,
    Q10,
    SAMPLES,
    SCHEDULES,
    START,
    TEMPERATURE,
    exact,
    lived,
    monitor,
    robot,
    settled,
    shop,
    three_hours,
)


def test_exponential_gathers_rate_times_time() -> None:
    rates = [(2e-5, 0.5), (7e-4, 1.25), (1e-6, 2.0)]
    measured = {"rate": {"topic": "/m", "field": "rate", "max_age": "2 h"}}
    part = {"hazard": {"model": "general.constant", "inputs": {"rate": "1e-5 /h"}}}
    design = robot({"part": part}, signals=measured, max_gap="3 h")
    expected = sum(Fraction(rate) * Fraction(hours) for rate, hours in rates)
    assert lived(design, three_hours("/m.rate", rates)).cumulative_hazard[0] == exact(expected)


@pytest.mark.parametrize("initial", [0, 70])
@pytest.mark.parametrize("beta", [0.6, 1, 2.5])
@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_weibull_under_both_scalings(scaling: str, beta: float, initial: int) -> None:
    life = {"distribution": "weibull", "scale": "100 h", "shape": beta}
    part = {"life": life, "acceleration": Q10, "scaling": scaling, "initial_exposure": f"{initial} h"}
    design = robot({"part": part}, **ALWAYS_ON)
    age, effective, hazard = mpf(initial), mpf(initial), (mpf(initial) / 100) ** beta
    for celsius, hours in HOURS:
        factor = mpf(2) ** ((mpf(celsius) - 25) / 10)
        hazard += factor * (((age + hours) / 100) ** beta - (age / 100) ** beta)
        age, effective = age + hours, effective + factor * hours
    expected = hazard if scaling == "hazard" else (effective / 100) ** beta
    assert lived(design, three_hours()).cumulative_hazard[0] == exact(expected)


@pytest.mark.parametrize("required", [1, 2, 3, 4])
def test_quantity_is_separate_parts(required: int) -> None:
    life = {"distribution": "weibull", "scale": "3 h", "shape": 2}
    design = robot({"part": {"life": life, "quantity": 4, "required": required}}, **ALWAYS_ON)
    works = mp.exp(-((mpf(15) / 4 / 3) ** 2))
    expected = [mp.binomial(4, k) * works**k * (1 - works) ** (4 - k) for k in range(5)]
    survival = lived(design, three_hours()).survival(design.diagram)
    assert survival.works == exact(sum(expected[required:]))
    assert survival.failed == exact(sum(expected[:required]))


def test_failure_modes_are_in_series() -> None:
    wear = {"life": {"distribution": "weibull", "scale": "3 h", "shape": 2}, "acceleration": Q10}
    design = robot({"part": {"failure_modes": {"wear": wear, "shock": {"rate": "0.01 /h"}}}}, **ALWAYS_ON)
    effective = sum(mpf(2) ** ((mpf(celsius) - 25) / 10) * hours for celsius, hours in HOURS)
    expected = (effective / 3) ** 2 + mpf("3.75") * mpf(0.01)
    assert lived(design, three_hours()).survival(design.diagram).works == exact(mp.exp(-expected))


def clocked(clock: str, binding: dict[str, Any] | None = None) -> Robot:
    unit = {"operating": "h", "calendar": "h", "kilometres": "km", "cycles": "cycle", "starts": "start"}[clock]
    usage = {"usage": {clock: f"3 {unit}/h"}} if clock not in ("operating", "calendar") else {}
    clocks = {"clocks": {clock: binding}} if binding else {}
    parts = {"part": {"rate": f"0.01 /{unit}", "clock": clock}}
    return robot(parts, powered={"topic": "/power", "field": "on"}, max_gap="10 h", **usage, **clocks)


ON_AND_OFF = [
    Sample(START, "/power.on", 1.0),
    Sample(START + HOUR, "/power.on", 0.0),
    Sample(START + 4 * HOUR, CLOCK, 0.0),
]
DRIVEN = [Sample(START + i * SECOND, "/o.v", v) for i, v in enumerate([0.25, -0.5, 0.75])]
WALKED = [
    sample
    for i, (x, y) in enumerate([(0, 0), (300, 400), (300, 400), (-300, -400)], 1)
    for sample in (Sample(START + i * SECOND, "/o.x", x), Sample(START + i * SECOND, "/o.y", y))
]
PRESSED = [Sample(START + i * SECOND, "/b.on", on) for i, on in enumerate([1, 1, 0, 1, 0, 0, 1, 1, 0], 1)]


@pytest.mark.parametrize(
    ("clock", "binding", "samples", "expected"),
    [
        ("operating", None, [], 1),
        ("calendar", None, [], 4),
        ("kilometres", None, [], 3),  # as the design says, while on
        ("kilometres", {"topic": "/o", "position": ["x", "y"]}, WALKED, Fraction("1.5")),
        ("kilometres", {"topic": "/o", "position": ["x"], "unit": "cm"}, WALKED[::2], Fraction("0.009")),
        ("kilometres", {"topic": "/o", "speed": "v", "max_age": "2 h"}, DRIVEN, Fraction("0.75") * (1 + 3598)),
        ("kilometres", {"topic": "/o", "speed": "v", "max_age": "1 s"}, DRIVEN, 1.5 + 3597 * 3000 / 3600),
        ("cycles", {"topic": "/b", "edge": "on"}, PRESSED, 2),
        ("starts", {"topic": "/b", "edge": "on", "threshold": 1.5}, PRESSED, 0),
    ],
)  # fmt: skip
def test_clocks(clock: str, binding: dict[str, Any] | None, samples: list[Sample], expected: Fraction) -> None:
    design = clocked(clock, binding)
    if binding and "speed" in binding:
        expected /= 1000  # m to km
    ledger = settled(design, sorted([*ON_AND_OFF, *samples]))
    assert ledger.age.value[0] == exact(expected)
    assert ledger.clocks.value[:2].tolist() == [exact(1), exact(4)]


def test_reference_stress_need_not_be_stated() -> None:
    part = {"rate": "1e-5 /h", "acceleration": {"model": "q10"}}
    (stress,) = robot({"part": part}, **ALWAYS_ON).modes[0].stresses
    assert stress.factor({"temperature": np.array([25.0, 35.0])}).value.tolist() == [1.0, 2.0]


def test_the_first_instant_can_be_looked_at() -> None:
    """No time has passed, so that no stress has acted; a handbook model is not asked about nothing."""
    design = shop(dict.fromkeys(SCHEDULES, SECOND), "nominal", SECOND, powered=False)
    assert not settled(design, [Sample(START, "/a.t", 20.0)]).effective.value.any()


def test_a_sample_out_of_range_is_counted_once_and_hides_no_other() -> None:
    design = shop(dict.fromkeys(SCHEDULES, 9 * SECOND), "nominal", SECOND, powered=False)
    samples = [Sample(START, "/a.t", 35.0), Sample(START, "/a.t", 999.0), Sample(START + HOUR // 3600, CLOCK, 0.0)]
    ledger = settled(design, samples)
    assert ledger.counts == {"out of range: /a.t": 1}
    seal = [mode.path for mode in design.modes].index("seal")
    assert ledger.effective.value[seal] == exact(mpf(2) / 3600)


def test_parts_whose_sensors_alone_differ_live_as_if_each_were_alone() -> None:
    """They are asked about together, to the last bit: one is silent, one speaks now and then, one leaves its range."""
    chance = random.Random(5)
    parts = {
        f"p{i}": {
            "rate": "1e-5 /h",
            "acceleration": {"model": "q10", "reference_temperature": f"{25 + 5 * (i == 4)} degC"},
            "signals": {"temperature": TEMPERATURE | {"topic": f"/t{i}", "max_age": "7 s"}},
        }
        for i in range(6)
    }
    always = {"powered": {"topic": "/on", "field": "data"}}
    samples = [Sample(START, "/on.data", 1.0)]
    for i, (count, warmest) in enumerate([(90, 60), (0, 60), (9, 60), (90, 1500), (90, 60), (90, 60)]):
        times = (START + chance.randrange(180 * SECOND) for _ in range(count))
        samples += [Sample(time, f"/t{i}.c", chance.uniform(-5, warmest)) for time in times]
    samples = [*sorted(samples), Sample(START + 180 * SECOND, CLOCK, 0.0)]
    together = settled(robot(parts, **always), samples, 30.0)
    for i, (name, part) in enumerate(parts.items()):
        own = [sample for sample in samples if sample.signal in ("/on.data", CLOCK, f"/t{i}.c")]
        alone = settled(robot({name: part}, **always), own, 30.0)
        assert together.effective.value[i] == alone.effective.value[0] > 0
        assert together.extrapolated[name] == alone.extrapolated[name]


def test_what_was_heard_in_the_first_instant_counts_from_it() -> None:
    """Integrated to the instant of the first samples, and then on: it is on, and stays so, without another word."""
    design = robot({"part": {"rate": "0.01 /h"}}, powered={"topic": "/power", "field": "on"})
    exposure, ledger = ExposureIntegrator(design), Ledger.new(design)
    ledger.started = START
    exposure.integrate(ledger, [Sample(START, "/power.on", 1.0)], START)
    exposure.integrate(ledger, [], START + 2 * HOUR)
    assert ledger.clocks.value.tolist() == [2.0, 2.0]


def test_nothing_of_a_stretch_stays() -> None:
    """Not even until Python looks for what refers to one another: a year of stretches takes the memory of one."""
    design = shop(dict.fromkeys(SCHEDULES, 5 * SECOND), "nominal", 5 * SECOND, powered=True)
    gc.collect()
    gc.disable()
    try:
        monitor(design, SAMPLES[:500], period=10).report()
        assert [one for one in gc.get_objects() if isinstance(one, SampleStretch)] == []
    finally:
        gc.enable()
