"""A sensor that dies never makes a robot look better, and what rests on silence is marked."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp, mpf

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.monitoring.monitor import Monitor

START = 1_700_000_040 * SECOND
T, V = "/t.c", "/v.u"
SIGNALS = {
    "temperature": {"topic": "/t", "field": "c", "range": [-40, 125]},
    "dc_voltage": {"topic": "/v", "field": "u", "range": [0, 45]},
}
CAPACITOR = {
    "model": "mil_hdbk_217f.capacitor",
    "inputs": {
        "style": "CK", "capacitance": "1 uF", "temperature": "40 degC", "dc_voltage": "15 V",
        "rated_voltage": "50 V", "environment": "GB",
    },
}  # fmt: skip
PART: dict[str, Any] = {"rate": "0.01 /h", "acceleration": {"model": "q10", "reference_temperature": "25 degC"}}


def robot(part: dict[str, Any], signals: dict[str, Any] | None = None, **more: Any) -> Robot:
    design = {"schema_version": 1, "name": "R", "signals": signals or {"temperature": SIGNALS["temperature"]}}
    return parse(json.dumps(design | {"components": {"part": part}, "max_gap": "1 h"} | more))


def hear(monitor: Monitor, seconds: range, **values: float) -> None:
    """A clock sample a second, and these signals."""
    for second in seconds:
        for signal, value in (*((one, values[name]) for name, one in (("t", T), ("v", V)) if name in values),):
            monitor.observe(Sample(START + second * SECOND, signal, value))
        monitor.observe(Sample(START + second * SECOND, CLOCK, 0.0))


def rate(monitor: Monitor) -> float:
    return monitor.report(remaining_life=False).system.sensor_based.hazard_rate


@pytest.mark.full
@given(
    first=st.sampled_from("tv"), hot=st.floats(-39, 124), volts=st.floats(0.1, 44), more=st.floats(-39, 124),
    scaling=st.sampled_from(["age", "hazard"]),
)  # fmt: skip
def test_no_death_of_a_sensor_lowers_the_rate(first: str, hot: float, volts: float, more: float, scaling: str) -> None:
    """One of two inputs of a part dies, then the other: of each, what ages faster of the last value and the nominal."""
    monitor = Monitor(robot({"hazard": CAPACITOR, "scaling": scaling}, SIGNALS), period=1)
    said = {"t": hot, "v": volts}
    hear(monitor, range(10), **said)
    lively = rate(monitor)
    (left,) = {"t", "v"} - {first}
    hear(monitor, range(10, 30), **{left: said[left]})
    one_dead = rate(monitor)
    hear(monitor, range(30, 60))
    both_dead = rate(monitor)
    assert lively <= one_dead <= both_dead

    def rate_at(celsius: float, u: float) -> mpf:  # §10.1: πT of column 2, πV of column 3
        heat = mp.exp(-mpf(0.35) / mpf(8.617e-5) * (1 / (mpf(celsius) + 273) - mpf(1) / 298))
        return heat * ((mpf(u) / 50 / mpf(0.6)) ** 3 + 1)

    worst = max(rate_at(celsius, u) for celsius in (hot, 40) for u in (volts, 15))
    assert both_dead / lively == pytest.approx(float(worst / rate_at(hot, volts)), rel=1e-12)
    hear(monitor, range(60, 62), t=more, v=volts)
    assert rate(monitor) / lively == pytest.approx(float(rate_at(more, volts) / rate_at(hot, volts)), rel=1e-12)


@pytest.mark.parametrize(("celsius", "factor"), [(45.0, 4), (5.0, 1)])
def test_what_is_ahead_does_not_improve_either(celsius: float, factor: int) -> None:
    """Neither after the ten minutes in which a recent mean was to be had, nor where a leg states another input."""
    monitor = Monitor(robot(PART), period=10)
    hear(monitor, range(60), t=celsius)
    hear(monitor, range(60, 1800, 10))
    report = monitor.report()
    life = report.system.sensor_based.remaining_life
    assert life is not None
    assert life.mean == pytest.approx(100 / factor, rel=1e-9)
    assert report.outlooks["sensor_based"].inputs == ({} if factor == 1 else {"/t.c 1.0 0.0 -40.0 125.0": celsius})


def test_a_signal_that_was_never_heard_is_nominal() -> None:
    monitor = Monitor(robot(PART, SIGNALS | {"temperature": SIGNALS["temperature"]}), period=1)
    hear(monitor, range(30), v=10.0)
    report = monitor.report(remaining_life=False)
    assert report.system.sensor_based.hazard_rate == pytest.approx(0.01, rel=1e-12)
    assert report.system.silence == "rests on silence since the beginning of /t.c"


def test_a_robot_that_is_off_is_as_designed_meanwhile() -> None:
    """Nobody expects a word of its sensors then: a night counts as the design says, not as the evening was."""
    part = PART | {"clock": "calendar"}
    monitor = Monitor(robot(part, max_gap="1 min"), period=1)
    hear(monitor, range(100), t=45.0)
    hear(monitor, range(100, 3700, 100))
    lived = monitor.report(remaining_life=False)
    on = 99 + 60  # heard until second 99, and taken to be on for a minute
    assert lived.clocks["operating"] * 3600 == pytest.approx(on, rel=1e-12)
    hazard = (on * 4 + (3600 - on)) * 0.01 / 3600
    assert -mp.log(lived.system.sensor_based.reliability) == pytest.approx(hazard, rel=1e-9)
    assert lived.system.sensor_based.hazard_rate == pytest.approx(0.04, rel=1e-12)  # of operation, if it went on now


def test_every_figure_says_since_when_it_rests_on_silence() -> None:
    monitor = Monitor(robot({"hazard": CAPACITOR}, SIGNALS), period=1)
    hear(monitor, range(10), t=40.0, v=15.0)
    assert monitor.report(remaining_life=False).system.silence == ""
    hear(monitor, range(10, 30), v=15.0)
    hear(monitor, range(30, 60))
    report = monitor.report(remaining_life=False)
    words = "rests on silence since 2023-11-14 22:14:09 UTC of /t.c, since 2023-11-14 22:14:29 UTC of /v.u"
    assert report.system.marks == ("stale /t.c", "stale /v.u", words)
    assert report.components[0].silence == words
    document = report.to_json()
    assert [document["subjects"][0]["silence"], document["components"][0]["silence"]] == [words, words]
    assert document["silent"] == {"/t.c": 1_700_000_049 * SECOND, "/v.u": 1_700_000_069 * SECOND}


def test_the_split_of_time_changes_nothing() -> None:
    """What lies between being on and off is cut there, wherever periods end."""
    part = PART | {"clock": "calendar"}
    ledgers = []
    for period in (7, 3600):
        monitor = Monitor(robot(part, max_gap="90 s"), period=period)
        hear(monitor, range(60), t=45.0)
        hear(monitor, range(400, 460), t=65.0)
        monitor.observe(Sample(START + HOUR, CLOCK, 0.0))
        ledgers.append(monitor.exposure.settled(monitor.ledger).effective.value)
    seconds = (59 + 90) * 4 + (400 - 59 - 90) + (59 + 90) * 16 + (3600 - 459 - 90)
    assert ledgers[0] == pytest.approx(ledgers[1], rel=1e-12)
    assert ledgers[0] == pytest.approx(seconds / 3600, rel=1e-12)
