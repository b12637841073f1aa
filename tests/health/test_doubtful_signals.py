"""Signals that may not be true: told of with what it would mean by closed forms, never corrected or without cause."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.report import HealthReport
from robophm.monitoring.monitor import Monitor

START = 1_700_006_400 * SECOND
EVERY = 1200
"""Seconds between two samples."""

Course = Callable[[np.ndarray], np.ndarray]
"""A signal's values by the hours since the start."""


def motor(topic: str) -> dict[str, Any]:
    return {
        "rate": "1e-5 /h",
        "acceleration": {"model": "q10", "reference_temperature": "25 degC"},
        "signals": {"temperature": {"topic": topic, "field": "c", "max_age": "1 h"}},
    }


def robot(**components: dict[str, Any]) -> Robot:
    design = {"schema_version": 1, "name": "R", "max_gap": "2 h", "task": {"duration": "10 h"}}
    return parse(json.dumps(design | {"modules": {"drive": {"components": components}}}))


MOTORS = robot(**{name: motor(f"/{name}") for name in ("left", "middle", "right", "rear")})


def lived(robot: Robot, days: float, **courses: Course) -> HealthReport:
    """The health of a robot whose signals went by courses for so long."""
    hours = np.arange(0, days * 24, EVERY / 3600)
    values = {name: course(hours) for name, course in courses.items()}
    monitor = Monitor(robot, period=3600)
    for i, hour in enumerate(hours.tolist()):
        for name, course in values.items():
            if not math.isnan(course[i]):
                monitor.observe(Sample(START + round(hour * HOUR), f"/{name}.c", float(course[i])))
    return monitor.report(remaining_life=False)


def daily(mean: float, seed: int) -> Course:
    """A course of the day, and noise."""
    return lambda hours: (
        mean + 8 * np.sin(2 * np.pi * hours / 24) + np.random.default_rng(seed).normal(0, 1, len(hours))
    )


def with_more(course: Course, more: Course) -> Course:
    return lambda hours: course(hours) + more(hours)


FINE = {"left": daily(40, 1), "middle": daily(45, 2), "right": daily(42, 3), "rear": daily(50, 4)}


def test_nothing_is_told_of_signals_that_are_fine() -> None:
    report = lived(MOTORS, 12, **FINE)
    assert report.doubts == ()
    assert report.notes == ()
    assert report.system.flags == ()
    assert report.state == "ok"


@pytest.mark.parametrize("by", [-25.0, 25.0])
def test_one_that_leaves_its_neighbours_is_told_of_with_what_it_means(by: float) -> None:
    jump = with_more(FINE["right"], lambda hours: np.where(hours >= 240, by, 0.0))
    report = lived(MOTORS, 12, **FINE | {"right": jump})
    (doubt,) = report.doubts
    assert doubt.about.signal == "/right.c"
    assert f"{'higher' if by > 0 else 'lower'} since 2023-11-25 00:00:00 UTC" in doubt.about.why
    assert "against 3 other signals of 'temperature'" in doubt.about.why
    flags = {one.path: one.flags for one in report.components}
    assert flags.pop("drive/right") == ("doubtful /right.c",)
    assert not any(flags.values())
    assert report.system.state == report.state == "warn"

    # λ of the last hour's means, by Q10: three motors as they are, and the fourth as it says or as it would fit
    assert doubt.about.instead is not None
    rates = {one.path: one.sensor_based_hazard_rate for one in report.components}
    right = rates.pop("drive/right")
    hours = np.arange(0, 288, EVERY / 3600)
    recent = float(jump(hours)[-1])
    assert right == pytest.approx(1e-5 * 2 ** ((recent - 25) / 10), rel=1e-12)
    fits = right * 2 ** ((doubt.about.instead - recent) / 10)
    assert doubt.hazard_rate == pytest.approx(sum(rates.values()) + fits, rel=1e-12)
    assert doubt.about.instead == pytest.approx(float(FINE["right"](hours)[-3:].mean()), abs=3.0)
    assert doubt.completion is not None
    before = [float(course(hours)[-2]) for name, course in FINE.items() if name != "right"]  # of the last ten minutes
    recently = sum(1e-5 * 2 ** ((value - 25) / 10) for value in (*before, doubt.about.instead))
    assert doubt.completion.failure == pytest.approx(-math.expm1(-10 * recently), rel=1e-12)
    figures = report.system.sensor_based
    assert figures.hazard_rate == pytest.approx(sum(rates.values()) + right, rel=1e-12)  # nothing is corrected
    (note,) = report.notes
    said = re.match(r"/right.c has been (\S+) °C", note)
    assert said
    assert float(said[1]) == pytest.approx(25, abs=0.6)
    assert f"hazard rate {doubt.hazard_rate:.4g} /h in place of {figures.hazard_rate:.4g} /h" in note
    (told,) = report.to_json()["doubts"]
    assert told["hazard_rate"] == doubt.hazard_rate
    assert told["completion"] == doubt.completion.probability


def test_what_all_do_together_is_no_ones_fault() -> None:
    hotter = {name: with_more(course, lambda hours: np.where(hours >= 240, 30.0, 0.0)) for name, course in FINE.items()}
    assert lived(MOTORS, 12, **hotter).doubts == ()


def test_a_signal_that_stands_still_is_told_of_as_if_it_were_silent() -> None:
    """Then the design's own temperature counts, 25 degC, at which the stated rate holds."""
    stuck = lambda hours: np.where(hours < 200, FINE["rear"](hours), 61.0)  # noqa: E731
    report = lived(MOTORS, 12, **FINE | {"rear": stuck})
    (doubt,) = report.doubts
    assert doubt.about.signal == "/rear.c"
    assert doubt.about.why == "has said 61 to the last digit since 2023-11-23 08:00:00 UTC"
    others = sum(one.sensor_based_hazard_rate for one in report.components if one.path != "drive/rear")
    assert doubt.hazard_rate == pytest.approx(others + 1e-5, rel=1e-12)


@pytest.mark.full
def test_one_alone_is_held_against_its_own_past() -> None:
    alone = robot(left=motor("/left"))
    assert lived(alone, 12, left=FINE["left"]).doubts == ()
    jump = with_more(FINE["left"], lambda hours: np.where(hours >= 240, 40.0, 0.0))
    (doubt,) = lived(alone, 12, left=jump).doubts
    assert doubt.about.why.endswith("its sensor has changed, or what it measures")
    drift = with_more(FINE["left"], lambda hours: hours / 24 / 4)
    (doubt,) = lived(alone, 60, left=drift).doubts
    assert "has risen by" in doubt.about.why


CAPACITOR = {
    "hazard": {
        "model": "mil_hdbk_217f.capacitor",
        "inputs": {
            "style": "CK", "capacitance": "1 uF", "temperature": "40 degC", "dc_voltage": "15 V",
            "rated_voltage": "50 V", "environment": "GB",
        },
    },
    "signals": {"temperature": {"topic": "/around", "field": "c", "max_age": "1 h"}},
}  # fmt: skip


@pytest.mark.parametrize(("inside", "told"), [(41.0, False), (38.5, False), (30.0, True)])
def test_a_part_is_not_colder_than_its_surroundings(inside: float, told: bool) -> None:
    """§10.1: the temperature of a capacitor is that around it; 3 K are within what sensors differ."""
    board = robot(capacitor=CAPACITOR, driver=motor("/inside"))
    report = lived(board, 0.5, around=lambda hours: np.full(len(hours), 40.0), inside=lambda h: np.full(len(h), inside))
    assert len(report.doubts) == 2 * told
    if told:
        around, own = report.doubts
        assert around.about.why == "reads 10 °C more than what is inside, /inside.c"
        assert (around.about.instead, own.about.instead) == (30.0, 40.0)
        rates = {one.path: one.sensor_based_hazard_rate for one in report.components}
        hotter = rates["drive/driver"] * 2  # 10 K more, by Q10
        assert own.hazard_rate == pytest.approx(rates["drive/capacitor"] + hotter, rel=1e-12)
        colder = math.exp(-0.35 / 8.617e-5 * (1 / (30 + 273) - 1 / (40 + 273)))  # πT, column 2
        assert around.hazard_rate == pytest.approx(rates["drive/capacitor"] * colder + rates["drive/driver"], rel=1e-12)


def told(report: HealthReport) -> dict[str, str]:
    return {one.about.signal: one.about.why for one in report.doubts}


def steady(**values: float) -> dict[str, Course]:
    return {name: (lambda hours, value=value: np.full(len(hours), value)) for name, value in values.items()}


PAIR = robot(left=motor("/left"), right=motor("/right"))


def test_of_two_that_part_it_may_be_either() -> None:
    """A fall of 12 K in a course of the day of 16 K, that neither's own past tells of."""
    fallen = with_more(FINE["right"], lambda hours: np.where(hours >= 240, -12.0, 0.0))
    left, right = lived(PAIR, 12, left=FINE["left"], right=fallen).doubts
    since = "since 2023-11-25 00:00:00 UTC, beyond all that it said before"
    assert re.fullmatch(rf"has been 1[123].* °C higher {since}, against /right.c", left.about.why)
    assert re.fullmatch(rf"has been 1[123].* °C lower {since}, against /left.c", right.about.why)
    assert (left.about.otherwise, right.about.otherwise) == ("if /right.c is right", "if /left.c is right")
    assert right.about.instead == pytest.approx(
        float(FINE["right"](np.arange(0, 288, EVERY / 3600))[-3:].mean()), abs=3
    )
    together = {
        name: with_more(FINE[name], lambda hours: np.where(hours >= 240, 40.0, 0.0)) for name in ("left", "right")
    }
    assert lived(PAIR, 12, **together).doubts == ()


@pytest.mark.parametrize(("other", "apart"), [(46.0, False), (55.0, True)])
def test_two_sensors_of_one_air_are_not_far_apart(other: float, apart: bool) -> None:
    signals = {"temperature": {"topic": "/other", "field": "c", "max_age": "1 h"}}
    board = robot(one=CAPACITOR, two=CAPACITOR | {"signals": signals})
    found = told(lived(board, 0.5, **steady(around=40.0, other=other)))
    expected = {
        "/around.c": "reads 15 °C less than /other.c, which is in the same surroundings",
        "/other.c": "reads 15 °C more than /around.c, which is in the same surroundings",
    }
    assert found == (expected if apart else {})


@pytest.mark.parametrize(("inside", "told_of"), [(31.0, False), (20.0, True)])
def test_what_is_deep_inside_is_not_colder_than_the_air_of_the_robot(inside: float, told_of: bool) -> None:
    design = {
        "schema_version": 1, "name": "R", "max_gap": "2 h",
        "signals": {"temperature": {"topic": "/air", "field": "c", "max_age": "1 h"}},
        "components": {"one": CAPACITOR | {"signals": {}}, "two": CAPACITOR | {"signals": {}}},
        "modules": {"box": {"modules": {"drive": {"components": {"driver": motor("/inside")}}}}},
    }  # fmt: skip
    found = told(lived(parse(json.dumps(design)), 0.5, **steady(air=33.0, inside=inside)))
    assert found.keys() == ({"/air.c", "/inside.c"} if told_of else set())


@pytest.mark.parametrize(("winding", "told_of"), [(48.0, False), (40.0, True)])
def test_a_winding_is_not_colder_than_its_case(winding: float, told_of: bool) -> None:
    """Of the other motor, which stands, nothing follows."""
    parts = {name: motor(f"/{name}") for name in ("left_winding", "left_case", "right_winding")}
    found = told(lived(robot(**parts), 0.5, **steady(left_winding=winding, left_case=50.0, right_winding=20.0)))
    expected = {
        "/left_winding.c": "reads 10 °C less than what is around it, /left_case.c",
        "/left_case.c": "reads 10 °C more than what is inside, /left_winding.c",
    }
    assert found == (expected if told_of else {})


WARM_BOARD = {
    "schema_version": 1, "name": "R", "max_gap": "2 h", "ambient": "40 degC",
    "signals": {"temperature": {"topic": "/air", "field": "c", "max_age": "1 h"}},
    "components": {
        "resistor": {"hazard": {"model": "mil_hdbk_217f.resistor", "inputs": {
            "style": "RM", "power": "0.1 W", "rated_power": "0.25 W", "temperature": "70 degC", "environment": "GB"}}},
        "capacitor": {"hazard": CAPACITOR["hazard"]},
        "driver": motor("/inside"),
    },
}  # fmt: skip


def test_a_rise_as_designed_is_not_the_temperature_of_the_air() -> None:
    """The resistor is taken to be 30 K warmer than the sensor: a driver at 45 degC is colder than it, not than air."""
    board = parse(json.dumps(WARM_BOARD))
    assert told(lived(board, 0.5, **steady(air=40.0, inside=45.0))) == {}
    assert told(lived(board, 0.5, **steady(air=40.0, inside=30.0))).keys() == {"/air.c", "/inside.c"}


def test_a_doubt_is_told_once_with_all_that_its_signal_drives() -> None:
    """217F 9.1: resistor, column 1 of πT; 10.1: capacitor, column 2; at 30 degC in the place of 40."""
    report = lived(parse(json.dumps(WARM_BOARD)), 0.5, **steady(air=40.0, inside=30.0))
    air, _ = report.doubts
    rates = {one.path: one.sensor_based_hazard_rate for one in report.components}
    kelvin = lambda energy, celsius: math.exp(-energy / 8.617e-5 * (1 / (celsius + 273) - 1 / 298))  # noqa: E731
    resistor, capacitor = kelvin(0.08, 60) / kelvin(0.08, 70), kelvin(0.35, 30) / kelvin(0.35, 40)
    expected = rates["resistor"] * resistor + rates["capacitor"] * capacitor + rates["driver"]
    assert air.hazard_rate == pytest.approx(expected, rel=1e-4)  # Boltzmann's constant in full


def test_what_one_signal_drives_in_several_ways_is_no_neighbour_of_its_own() -> None:
    """Three rises of one sensor, and one other: of two signals it may be either."""
    hot = lambda rise: {"rate": "1e-5 /h", "acceleration": {"model": "q10"}, "offsets": {"temperature": f"{rise} K"}}  # noqa: E731
    design = {
        "schema_version": 1, "name": "R", "max_gap": "2 h",
        "signals": {"temperature": {"topic": "/left", "field": "c", "max_age": "1 h"}},
        "components": {"a": hot(5), "b": hot(10), "c": hot(15), "right": motor("/right")},
    }  # fmt: skip
    jump = with_more(
        with_more(FINE["left"], lambda hours: 30 + 0 * hours), lambda hours: np.where(hours >= 240, 12.0, 0.0)
    )
    found = lived(parse(json.dumps(design)), 12, left=FINE["left"], right=jump).doubts
    assert [one.about.otherwise for one in found] == ["if /right.c is right", "if /left.c is right"]
