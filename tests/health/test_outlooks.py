"""From what was heard of a robot to how it goes on: the last ten minutes, silence, nights off, clocks that stand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.task import Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import as_designed, outlooks
from robophm.health.plant import Plant
from robophm.health.report import VIEWS, HealthReport
from robophm.health.subject import figures as all_figures
from robophm.monitoring.monitor import Monitor

from .prognoses import exact, hours, life, robot, task

START = 1_700_000_000 * SECOND


Q10 = {"model": "q10"}
HOT = {"temperature": {"topic": "/t", "field": "c", "unit": "degC", "max_age": "10 s", "range": [-40, 600]}}


def watched(components: dict[str, Any], celsius: list[tuple[int, float]], until: int, **more: Any) -> Monitor:
    """A monitor that has seen a value every 5 s: pieces of (seconds, value), NaN for silence."""
    design = robot(components, **{"signals": HOT, **more})
    observer, now = Monitor(design), START // (60 * SECOND) * 60 * SECOND
    first = now
    for seconds, value in celsius:
        for _ in range(seconds // 5):
            if not math.isnan(value):
                observer.observe(Sample(now, "/t.c", value))
            now += 5 * SECOND
    observer.observe(Sample(first + until * SECOND + SECOND, CLOCK, 0.0))
    return observer


def looked_at(observer: Monitor) -> HealthReport:
    return observer.report(settled=False)


PART = {"part": {"rate": "1e-3 /h", "acceleration": Q10}}
TWENTY_FIVE = {"task": {"duration": "25 h"}}


def test_the_last_ten_minutes_drive_the_future_and_the_present_the_hazard_now() -> None:
    report = looked_at(watched(PART, [(1200, 65.0), (300, 35.0), (300, 45.0)], 1800, **TWENTY_FIVE))
    figures = report.system.sensor_based
    assert figures.hazard_rate == exact(4e-3)  # 45 °C is four times the rate at 25
    assert figures.reliability == exact(mp.exp(-mpf("1e-3") * (1200 * 16 + 300 * 2 + 300 * 4) / 3600))
    assert life(figures).mean == exact(1 / mpf("3e-3"), 1e-10)  # mean of 2 and 4
    assert task(figures).probability == exact(mp.exp(-25 * mpf("3e-3")))
    nominal = report.system.nominal
    assert nominal.hazard_rate == exact(1e-3)
    assert nominal.reliability == exact(mp.exp(-mpf("1e-3") / 2))
    assert task(nominal).probability == exact(mp.exp(-25 * mpf("1e-3")))
    assert report.system.flags == ()


@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_stress_ahead_ages_or_weighs_as_it_did(scaling: str) -> None:
    """A Weibull part of shape 2 at twice its rate: (u + 2m)² − u² or 2·((a + m)² − a²)."""
    wear = {"distribution": "weibull", "scale": "10 h", "shape": 2}
    part = {"life": wear, "scaling": scaling, "acceleration": Q10, "initial_exposure": "3 h"}
    report = looked_at(watched({"part": part}, [(3600, 35.0)], 3600, task={"duration": "2 h"}))
    lived, ahead = (5**2, 9**2 - 5**2) if scaling == "age" else (3**2 + 2 * (4**2 - 3**2), 2 * (6**2 - 4**2))
    figures = report.system.sensor_based
    assert figures.reliability == exact(mp.exp(-mpf(lived) / 100))
    assert task(figures).probability == exact(mp.exp(-mpf(ahead) / 100))
    assert report.reliability(hours=2) == exact(mp.exp(-mpf(lived + ahead) / 100))
    assert figures.hazard_rate == exact(mpf(2 * 2 * (5 if scaling == "age" else 4)) / 100)
    assert report.system.nominal.hazard_rate == exact(mpf(2 * 4) / 100)


def test_without_a_past_the_future_is_nominal() -> None:
    design = robot(PART, signals=HOT)
    views = outlooks(Plant(design), ExposureIntegrator(design), Ledger.new(design))
    nominal, lived = (all_figures(views[view], design.diagram, hours(25)) for view in VIEWS)
    assert nominal == lived


def test_what_was_before_a_long_silence_is_not_recent() -> None:
    day = 24 * 3600
    observer = watched(PART, [(1200, 65.0), (day, math.nan), (120, 45.0)], 1200 + day + 120, **TWENTY_FIVE)
    assert task(looked_at(observer).system.sensor_based).probability == exact(mp.exp(-25 * mpf("4e-3")))


def test_a_night_off_does_not_make_the_calendar_run_faster() -> None:
    """The hazard now is of an hour of operation, whatever the share of the day that the robot was on."""
    observer = watched({"seal": {"rate": "1e-3 /h", "clock": "calendar", "acceleration": Q10}}, [(600, 25.0)], 600)
    for minute in range(8 * 60, 8 * 60 + 5):
        observer.observe(Sample(START + minute * 60 * SECOND, "/t.c", 25.0))
    report = looked_at(observer)
    assert report.clocks["calendar"] > 7 * report.clocks["operating"]
    assert report.system.sensor_based.hazard_rate == exact(1e-3)
    curve = report.outlooks["sensor_based"].survival_curve(observer.robot.diagram, np.array([0.0, 100.0]))
    assert curve.works[1] / curve.works[0] == exact(mp.exp(-mpf("0.1")))


@pytest.mark.parametrize(("stale", "factor"), [("nominal", 1), ("hold", 4), ("worst", 2**10)])
def test_silence_is_flagged_and_its_policy_holds(stale: str, factor: int) -> None:
    signals = {"temperature": {**HOT["temperature"], "stale": stale, "range": [-40, 125]}}
    report = looked_at(watched(PART, [(60, 45.0)], 120, signals=signals, max_gap="1 h"))
    assert report.system.flags == ("stale /t.c",)
    assert report.system.sensor_based.hazard_rate == exact(1e-3 * factor)
    expected = (mpf(65) * 4 + 55 * factor) / 3600 * mpf("1e-3")  # the last value, of second 55, holds for 10 s
    assert report.system.sensor_based.unreliability == exact(-mp.expm1(-expected))
    assert "no valid value for 55 s of operation: /t.c" in report.notes


def test_beyond_the_range_of_the_model_is_flagged_and_counted() -> None:
    part = {"part": {"rate": "1e-18 /h", "acceleration": Q10}}
    inside = looked_at(watched(part, [(60, 500.0)], 60))
    beyond = looked_at(watched(part, [(60, 500.5)], 60))
    assert inside.system.flags == ()
    assert beyond.system.flags == ("extrapolated",)
    assert beyond.system.sensor_based.hazard_rate == exact(mpf("1e-18") * mpf(2) ** mpf("47.55"))


def test_what_was_not_taken_is_told() -> None:
    observer = watched(PART, [(120, 45.0)], 120)
    now = observer.ledger.integrated_to or 0
    for sample in (
        Sample(now, "/t.c", 20.0),
        Sample(now - HOUR, "/t.c", 20.0),
        Sample(now + SECOND, "/t.c", 601.0),
        Sample(now + SECOND, "/t.c", math.nan),
        Sample(now + SECOND, "/t.c", -math.inf),
        Sample(now + 2 * SECOND, CLOCK, 0.0),
    ):
        observer.observe(sample)
    assert set(observer.report().notes) == {
        "1 samples not taken: out of range: /t.c",
        "2 samples not taken: late: /t.c",
        "2 samples not taken: not finite: /t.c",
    }


def test_a_clock_goes_on_as_it_lately_went() -> None:
    """0.5 m/s in the last ten minutes is 1.8 km of every hour of operation; the design says 1."""
    wheels = {"rate": "1e-3 /km", "clock": "kilometres"}
    drive = {"kilometres": {"topic": "/t", "speed": "c", "max_age": "10 s"}}
    observer = watched({"wheels": wheels}, [(600, 0.5)], 600, signals={}, clocks=drive, usage={"kilometres": "1 km/h"})
    report = looked_at(observer)
    assert report.clocks["kilometres"] == exact(0.3)
    assert report.system.nominal.hazard_rate == exact(1e-3)
    assert report.system.sensor_based.hazard_rate == exact(1.8e-3)
    assert report.remaining_life().mean == exact(1 / mpf("1.8e-3"), 1e-10)
    assert report.completion(Task.plain(2000.0, 1.0)).probability == exact(mp.exp(-mpf("2e-3")))  # a task says how far


def test_a_wheel_that_stands_cannot_wear() -> None:
    wheel = {"life": {"distribution": "weibull", "scale": "1000 km", "shape": 0.5}, "clock": "kilometres"}
    design = robot({"wheel": wheel}, usage={"kilometres": "0 km/h"})
    assert as_designed(Plant(design)).hazard_rate(design.diagram) == 0


def test_the_calendar_runs_on_while_the_robot_rests() -> None:
    """Ten hours of operation are a hundred of the calendar for a robot that works a tenth of the day."""
    design = robot({"seal": {"rate": "1e-3 /h", "clock": "calendar"}}, usage={"operating": 0.1})
    outlook = as_designed(Plant(design))
    curve = outlook.survival_curve(design.diagram, np.array([10.0]))
    assert curve.works[0] == exact(mp.exp(-mpf("0.1")))
    median = outlook.remaining_life(design.diagram).median
    assert outlook.survival_curve(design.diagram, np.array([median / 10])).works[0] == exact(0.5)
