"""Figures that follow from exposure, against closed forms, mpmath and published ones."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from robophm.design.task import Knowledge, Leg, Task
from robophm.health.mission import Completion, completion
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.subject import Figures
from robophm.health.subject import figures as all_figures
from robophm.health.uncertainty import life_uncertainty

from .prognoses import exact, hours, life, robot, task


def figures(components: dict[str, Any], ahead: Task | None = None, **more: Any) -> Figures:
    """Of a robot as its design says, with the initial exposure that its parts have."""
    design = robot(components, **more)
    return all_figures(as_designed(Plant(design)), design.diagram, ahead)


def quantiles(found: Figures) -> list[float]:
    return [life(found).early, life(found).median, life(found).late]


def test_exponential_series() -> None:
    rates = [mpf(1e-4), mpf(2e-3), mpf(5e-6)]
    total = sum(rates)
    parts = {f"p{i}": {"rate": f"{float(rate)!r} /h", "initial_exposure": "30 h"} for i, rate in enumerate(rates)}
    found = figures(parts, hours(7.5))
    assert found.hazard_rate == exact(total)
    assert found.reliability == exact(mp.exp(-30 * total))
    assert found.unreliability == exact(-mp.expm1(-30 * total))
    assert life(found).mean == exact(1 / total, 1e-10)
    assert quantiles(found) == pytest.approx([float(-mp.log(1 - mpf(q)) / total) for q in (0.05, 0.5, 0.95)])
    assert task(found).probability == exact(mp.exp(-7.5 * total))
    assert task(found).failure == exact(-mp.expm1(-7.5 * total))


def pair(rate: float, age: float, *, monitored: bool) -> dict[str, Any]:
    part = {"rate": f"{rate!r} /h", "initial_exposure": f"{age!r} h", "monitored": monitored}
    return {"components": {"left": part, "right": part}, "diagram": {"parallel": ["left", "right"]}}


def of_pair(rate: float, age: float, ahead: float) -> tuple[mpf, mpf]:
    """P(a pair fails in the time ahead, survives it | it works at this age): c/(c + s) and s/(c + s)."""
    now, end = (-mp.expm1(-mpf(rate) * t) for t in (mpf(age), mpf(age) + mpf(ahead)))
    return (end**2 - now**2) / (1 - now**2), (1 - end**2) / (1 - now**2)


@pytest.mark.parametrize("ahead", [1e-9, 1.0, 3e4, 5e6])
@pytest.mark.parametrize("age", [0.0, 20.0, 1e5])
@pytest.mark.parametrize("monitored", [True, False])
def test_redundant_pair(age: float, ahead: float, monitored: bool) -> None:
    rate = 3e-5
    found = figures(**pair(rate, age, monitored=monitored), ahead=hours(ahead))
    known = 0.0 if monitored else age  # a part known to work is as new: its life is exponential
    fails, survives = of_pair(rate, known, ahead)
    assert task(found).failure == exact(fails)
    assert task(found).probability == exact(survives)
    q = -mp.expm1(-mpf(rate) * known)
    assert found.hazard_rate == exact(2 * rate * (1 - q) * q / (1 - q**2))  # 0 while both are known to work
    assert found.reliability == exact(1 - mp.expm1(-mpf(rate) * age) ** 2)  # since new, whatever is known
    assert life(found).mean == exact((mpf(3) / 2 + q / 2) / (1 + q) / rate, 1e-10)
    roots = [1 - mp.sqrt(mpf(f) + (1 - mpf(f)) * q**2) for f in (0.05, 0.5, 0.95)]  # p at that time
    expected = [float(-mp.log(p) / mpf(rate) - known) for p in roots]
    assert quantiles(found) == pytest.approx(expected, rel=1e-11)


def test_weibull_that_has_lived() -> None:
    """RePyability: Weibull(100, 2), mean residual life at 40 is 59.45 and R(60 | 50) = 0.8958."""
    part = {"life": {"distribution": "weibull", "scale": "100 h", "shape": 2}}
    at_40 = figures({"part": {**part, "initial_exposure": "40 h"}})
    assert round(life(at_40).mean, 2) == 59.45
    tail = mp.quad(lambda t: mp.exp(mpf(0.16) - (t / 100) ** 2), [40, 100, 200, 400, mp.inf])
    assert life(at_40).mean == exact(tail, 1e-10)
    expected = [float(100 * mp.sqrt(mpf("0.16") - mp.log(1 - mpf(q))) - 40) for q in (0.05, 0.5, 0.95)]
    assert quantiles(at_40) == pytest.approx(expected, rel=1e-11)
    at_50 = figures({"part": {**part, "initial_exposure": "50 h"}}, hours(10))
    assert round(task(at_50).probability, 4) == 0.8958
    assert task(at_50).probability == exact(mp.exp(-mpf("0.11")))
    assert at_50.hazard_rate == exact(mpf("0.01"))  # 2 · 50 / 100²


def test_laser_and_camera_of_the_case_study() -> None:
    """A parallel block has no constant rate; 1/MTTF of the paper's 8e-8 and 5.88e-9 /h is 5.85e-9 /h."""
    parts = {"laser": {"rate": "8e-8 /h"}, "camera": {"rate": "5.88e-9 /h"}}
    found = figures(parts, diagram={"parallel": ["laser", "camera"]})
    one, other = mpf("8e-8"), mpf("5.88e-9")
    assert life(found).mean == exact(1 / one + 1 / other - 1 / (one + other), 1e-10)
    assert f"{1 / life(found).mean:.2e}" == "5.85e-09"
    assert found.hazard_rate == 0


@pytest.mark.parametrize("distribution", ["weibull", "lognormal", "loglogistic", "gamma"])
def test_tails_of_a_task(distribution: str) -> None:
    """Two monitored parts: both 1e-30 of failing and 1e-30 of surviving keep all digits."""
    shape = {"log_deviation": 0.5} if distribution == "lognormal" else {"shape": 3.0}
    part = {"rate": "0.001 /h", "life": {"distribution": distribution, **shape}, "monitored": True}
    design = robot({"a": part, "b": part}, diagram={"parallel": ["a", "b"]})
    alone = design.modes[0].life
    for ahead in (float(alone.quantile(1e-15)), float(alone.age_at(70.0))):
        found = completion(as_designed(Plant(design)), hours(ahead))
        H = mpf(float(alone.cumulative_hazard(ahead)))
        assert found.failure == exact(mp.expm1(-H) ** 2)
        assert found.probability == exact(1 - mp.expm1(-H) ** 2)
        assert min(found.failure, found.probability) < 1e-29


MIXED = {
    "wheel": {"life": {"distribution": "weibull", "scale": "900 km", "shape": 2}, "clock": "kilometres", "quantity": 2},
    "motor": {"rate": "1e-3 /h", "quantity": 3, "required": 2, "initial_exposure": "100 h"},
    "gripper": {"rate": "1e-5 /cycle", "clock": "cycles", "monitored": True},
    "seal": {"life": {"distribution": "gamma", "shape": 2, "scale": "5000 h"}, "clock": "calendar"},
}
USAGE = {"kilometres": "2 km/h", "cycles": "40 cycle/h", "operating": 0.5}
DIAGRAM = {"series": ["wheel", "seal", {"parallel": ["motor", {"series": ["gripper", "wheel"]}]}]}
DESIGN = robot(MIXED, usage=USAGE, diagram=DIAGRAM)
OUTLOOK = as_designed(Plant(DESIGN))


def test_an_empty_task_is_always_completed() -> None:
    found = completion(OUTLOOK, Task.plain(0.0, 0.0), DESIGN.diagram)
    assert (found.probability, found.failure) == (1.0, 0.0)


@given(st.floats(0, 1e6), st.floats(0, 1e6), st.floats(0, 1e4), st.floats(0, 1e4))
def test_a_longer_task_never_helps(distance: float, farther: float, duration: float, longer: float) -> None:
    short = completion(OUTLOOK, Task.plain(distance, duration), DESIGN.diagram)
    long = completion(OUTLOOK, Task.plain(distance + farther, duration + longer), DESIGN.diagram)
    assert long.probability <= short.probability * (1 + 1e-15)
    assert long.failure >= short.failure * (1 - 1e-15)
    assert long.probability + long.failure == pytest.approx(1, rel=1e-15)


@pytest.mark.parametrize(
    "written",
    [
        {"distance": "2.5 km", "speed": "0.3 m/s"},
        {"distance": "2500 m", "speed": "1.08 km/h"},
        {"distance": "250000 cm", "duration": f"{2500 / 0.3!r} s"},
        {"duration": f"{2500 / 1080!r} h", "speed": "30 cm/s"},
    ],
)
def test_units_of_a_task_change_nothing(written: dict[str, str]) -> None:
    design = robot(MIXED, usage=USAGE, diagram=DIAGRAM, task=written)
    assert design.task
    found = completion(OUTLOOK, design.task, DESIGN.diagram)
    expected = completion(OUTLOOK, Task.plain(2500, 2500 / 0.3 / 3600), DESIGN.diagram)
    assert found.probability == exact(expected.probability)
    assert found.failure == exact(expected.failure)


def test_every_clock_advances_in_a_task_and_in_the_life_ahead() -> None:
    """One part on each clock: by hand, distance for kilometres, usage for cycles, all of the time for calendar."""
    clocks = {"operating": "h", "calendar": "h", "kilometres": "km", "cycles": "cycle"}
    parts = {clock: {"rate": f"0.001 /{unit}", "clock": clock} for clock, unit in clocks.items()}
    design = robot(parts, usage=USAGE)
    outlook = as_designed(Plant(design))
    advance = {"operating": 3.0, "calendar": 3.0, "kilometres": 5.0, "cycles": 120.0}
    per_hour = {"operating": 0.5, "calendar": 1.0, "kilometres": 1.0, "cycles": 20.0}  # half of the day
    for clock, mode in zip(clocks, design.components, strict=True):
        (alone,) = (block for block in design.diagram.blocks if block.name == mode.path)  # type: ignore[attr-defined]
        found = completion(outlook, Task.plain(5000.0, 3.0), alone)
        assert found.probability == exact(mp.exp(-mpf(0.001) * advance[clock]))
        assert outlook.remaining_life(alone).mean == exact(1 / (mpf(0.001) * per_hour[clock]), 1e-10)


def test_a_robot_that_works_has_survived_whatever_its_odds() -> None:
    """Its only part is known to work by that, however unlikely it was to."""
    found = figures({"part": {"rate": "1 /h", "initial_exposure": "1e6 h"}}, hours(1))
    assert found.reliability == 0
    assert (task(found).probability, life(found).mean) == (exact(mp.exp(-1)), exact(1, 1e-10))


def test_redundancy_has_survived_too_whatever_its_odds() -> None:
    """It works, so that one of the pair does; that both do is e⁻¹⁰⁰⁰⁰⁰⁰ of that."""
    part = {"rate": "1 /h", "initial_exposure": "1e6 h", "quantity": 2, "required": 1}
    found = figures({"part": part}, hours(1))
    assert found.reliability == 0
    assert found.hazard_rate == exact(1)
    assert (task(found).probability, task(found).failure) == (exact(mp.exp(-1)), exact(-mp.expm1(-1)))
    remaining = life(found)
    assert (remaining.mean, remaining.median) == (exact(1, 1e-10), exact(mp.log(2)))
    assert (remaining.early, remaining.late) == (exact(-mp.log(mpf("0.95")), 1e-10), exact(mp.log(20), 1e-10))


def test_a_broken_arm_does_not_zero_a_task_that_only_drives() -> None:
    parts = {"arm": {"rate": "1 /h"}, "wheels": {"rate": "1e-3 /h"}}
    design = robot(parts, functions={"drive": "wheels"})
    outlook = as_designed(Plant(design), Knowledge(failed=frozenset({"arm"})))
    drive, everything = Task((Leg(1.0, functions=("drive",)),)), hours(1)
    assert completion(outlook, drive).probability == exact(mp.exp(-mpf(0.001)))
    assert completion(outlook, drive, design.functions["drive"]).probability == exact(mp.exp(-mpf(0.001)))
    assert completion(outlook, everything) == Completion(0.0, 1.0)
    assert outlook.remaining_life(design.diagram) == RemainingLife(0, 0, 0, 0)
    assert outlook.hazard_rate(design.diagram) == math.inf


@pytest.mark.parametrize("beta", [1.1, 1.5])
def test_a_heavy_tail_has_a_mean(beta: float) -> None:
    """Log-logistic lives have a mean where β > 1: η · (π/β) / sin(π/β), however slowly it is gathered."""
    found = figures({"part": {"life": {"distribution": "loglogistic", "scale": "1e5 h", "shape": beta}}})
    expected = mpf("1e5") * (mp.pi / mpf(beta)) / mp.sin(mp.pi / mpf(beta))
    assert life(found).mean == exact(expected, 1e-10)


@pytest.mark.parametrize("distribution", ["weibull", "gamma", "lognormal", "normal", "extreme_value", "rayleigh"])
def test_remaining_life_of_each_distribution_is_finite_and_in_order(distribution: str) -> None:
    shape = {"weibull": {"shape": 0.5}, "gamma": {"shape": 0.5}, "lognormal": {"log_deviation": 1}}.get(
        distribution, {}
    )
    shape |= {"deviation": "300 h"} if distribution == "normal" else {}
    shape |= {"scale": "200 h"} if distribution == "extreme_value" else {}
    part = {"rate": "1e-3 /h", "life": {"distribution": distribution, **shape}, "initial_exposure": "50 h"}
    found = life(figures({"part": part}))
    assert 0 < found.early < found.median < found.late < math.inf
    of_part = robot({"part": part}).modes[0].life
    assert found.mean == exact(of_part.mean_residual_life(50.0), 1e-9)


@pytest.mark.parametrize("quantity", [1, 5])
def test_hazards_that_add_up_to_more_than_a_number_holds(quantity: int) -> None:
    """Far ahead: H of one part, 7.9e307 after 1e160 h, is a number, and that of ten or of twice five is none."""
    weibull = {"rate": "1e-6 /h", "life": {"distribution": "weibull", "shape": 2}, "quantity": quantity}
    found = life(figures({f"part {i}": weibull for i in range(10 // quantity)}))
    eta = mpf(10) ** 6 / mp.gamma(mpf(3) / 2)
    assert found.median == exact(eta * mp.sqrt(mp.log(2) / 10), 1e-10)
    assert found.mean == exact(mpf(10) ** 6 / mp.sqrt(10), 1e-9)


def test_survival_ahead_is_since_new() -> None:
    part = {"life": {"distribution": "weibull", "scale": "100 h", "shape": 2}, "initial_exposure": "50 h"}
    design = robot({"part": part})
    state = as_designed(Plant(design)).survival_curve(design.diagram, np.array([0.0, 10.0]))
    assert state.works.tolist() == pytest.approx([float(mp.exp(-mpf("0.25"))), float(mp.exp(-mpf("0.36")))], rel=1e-14)
    assert (state.density / state.works).tolist() == pytest.approx([0.01, 0.012], rel=1e-14)


def test_a_component_counts_all_of_its_parts() -> None:
    plant = Plant(robot({"small": {"rate": "1e-6 /h"}, "three": {"rate": "4e-6 /h", "quantity": 3, "required": 2}}))
    assert as_designed(plant).component_hazard_rates().tolist() == [exact(1e-6), exact(12e-6)]


def test_equal_parts_of_a_component_are_stated_together() -> None:
    design = robot({"part": {"rate": "1e-3 /h", "quantity": 4, "required": 3, "initial_exposure": "10 h"}})
    outlook: Outlook = as_designed(Plant(design))
    assert outlook.component_hazard_rates().tolist() == [exact(4e-3)]
    works, failed = outlook.component_survival()
    assert works.tolist() == [exact(mp.exp(-mpf("0.04")))]
    assert failed.tolist() == [exact(-mp.expm1(-mpf("0.04")))]


def test_an_infinite_hazard_is_kept_away_by_redundancy() -> None:
    """Infant mortality: h(0) is infinite for a part alone, and f = h·p·q of the other, 0, for a pair."""
    young = {"life": {"distribution": "weibull", "scale": "1000 h", "shape": 0.5}}
    pair = robot({"young": young, "spare": {"rate": "1e-3 /h"}}, diagram={"parallel": ["young", "spare"]})
    alone = robot({"young": young})
    assert as_designed(Plant(pair)).hazard_rate(pair.diagram) == 0
    assert as_designed(Plant(alone)).hazard_rate(alone.diagram) == math.inf
    curve = as_designed(Plant(alone)).survival_curve(alone.diagram, np.array([0.0, 1000.0]))
    assert curve.density.tolist() == [math.inf, exact(mp.exp(-1) / 2000)]


def test_a_rate_under_which_the_robot_could_not_have_lived_says_nothing_of_what_is_ahead() -> None:
    """A silent pair of 1e5 h: at 1e-2 /h it would work with probability e⁻¹⁰⁰⁰, which no number holds."""
    part = {"rate": "1e-4 /h", "initial_exposure": "1e5 h", "uncertainty": {"samples": ["1e-4 /h", "1e-2 /h"]}}
    built = robot({"pair": part | {"quantity": 2, "required": 1}})
    found = life_uncertainty(as_designed(Plant(built)), built.diagram, draws=200).all_sources

    def survives(hours: float) -> mpf:
        works = mp.exp(-mpf("1e-4") * (mpf(10) ** 5 + hours))
        return works * (2 - works)

    for level, time in zip((0.05, 0.5, 0.95), found, strict=True):
        assert survives(time) / survives(0) == exact(1 - level, 1e-6)
