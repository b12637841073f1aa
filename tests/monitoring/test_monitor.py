"""The loop from samples to health: silence, disorder, floods and journals."""

from __future__ import annotations

import itertools
import json
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf

import robophm
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.transports.recordings.journal import Journal

from .designs import bound, exact, robot

OTA = Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml"
START = 1_700_000_040 * SECOND  # a whole minute


# Time is what samples say.

T = "/t.c"


def test_clock_samples_make_silence_heard() -> None:
    observer = Monitor(robot(**bound("/t", "c")))
    for second in range(11):
        observer.observe(Sample(START + second * SECOND, T, 35.0))
    spoken = observer.report()
    for second in range(10, 301, 10):
        observer.observe(Sample(START + second * SECOND, CLOCK, 0.0))
    report = observer.report()
    assert (spoken.clocks["calendar"] * 3600, spoken.system.flags) == (exact(10), ())
    assert (report.clocks["calendar"] * 3600, report.system.flags) == (exact(300), ("stale /t.c",))
    assert report.clocks["operating"] * 3600 == exact(70)  # and a minute, then it is taken to be off
    assert report.system.sensor_based.unreliability == exact(
        -mp.expm1(-mpf("0.01") * (15 * 2 + 55 * 2) / 3600)
    )  # as hot as last heard


def test_the_robot_is_not_on_before_it_is_heard() -> None:
    observer = Monitor(robot(**bound("/t", "c")))
    for sample in (
        Sample(START, CLOCK, 0.0),
        Sample(START + 30 * SECOND, T, 25.0),
        Sample(START + 40 * SECOND, T, 25.0),
    ):
        observer.observe(sample)
    assert [one * 3600 for one in observer.report().clocks.values()] == [exact(10), exact(40)]


def test_late_samples_are_counted_and_dropped_disorder_within_the_window_is_none() -> None:
    stamps = [0, 60, 59.5, 61, 60.2, 60, 59.9, 0]  # the tick of second 60 comes with 61
    hot = [25, 25, 35, 25, 35, 45, 65, 65]
    observer = Monitor(robot(**bound("/t", "c", max_age="2 min")))
    for second, celsius in zip(stamps, hot, strict=True):
        observer.observe(Sample(START + round(second * SECOND), T, celsius))
    assert observer.ledger.counts == {"late: /t.c": 3}
    # 25 °C to 59.5, 35 to 60, 25 to 60.2, 35 to 61
    assert observer.exposure.settled(observer.ledger).effective.value[0] * 3600 == exact(59.5 + 2 * 0.5 + 0.2 + 2 * 0.8)


def test_a_year_of_silence_is_a_step_not_a_million() -> None:
    year, ticks = 365 * 24 * HOUR, []
    observer = Monitor(robot(**bound("/t", "c")), on_tick=lambda monitor: ticks.append(monitor.ledger.integrated_to))
    begun = time.process_time()
    for at in (0, 1, year, year + SECOND):
        observer.observe(Sample(START + at, T, 35.0))
    assert time.process_time() - begun < 1
    assert len(ticks) <= 2
    report = observer.report()
    assert report.clocks["calendar"] == exact(Fraction(year + SECOND, HOUR))
    assert report.clocks["operating"] * 3600 == exact(61 + Fraction(1, SECOND))


def test_a_journal_of_the_run_gives_its_ledger_bit_for_bit(tmp_path: Path) -> None:
    design = robot(**bound("/t", "c", range=[-20, 80]), powered={"topic": "/p", "field": "on"})
    live, chance = Monitor(design), np.random.default_rng(8)
    with Journal(tmp_path / "run.journal", design.signals) as journal:
        for step in range(1500):
            now = START + step * SECOND // 3
            late = round(abs(chance.normal(0, 0.3)) * SECOND) + 60 * SECOND * (step % 97 == 0)
            if 600 < step < 900:  # silence, but for the monitor's own clock
                sample = Sample(now, CLOCK, 0.0)
            elif step % 50 == 0:
                sample = Sample(now - late, "/p.on", float(chance.random() < 0.8))
            else:
                sample = Sample(
                    now - late, T, float(chance.choice([chance.normal(40, 25), np.nan, np.inf], p=[0.96, 0.02, 0.02]))
                )
            journal.write(sample)
            live.observe(sample)
    assert {reason.split(":")[0] for reason in live.ledger.counts} == {"late", "not finite", "out of range"}
    store = MemoryStore()
    report = replay(design, tmp_path / "run.journal", store=store)
    assert store.ledger("R") == json.loads(json.dumps(live.ledger.to_json()))
    assert report == live.report()


def test_ticks_are_whole_periods() -> None:
    ticks: list[int] = []
    observer = Monitor(robot(), period=7, on_tick=lambda monitor: ticks.append(monitor.ledger.integrated_to or 0))
    for step in itertools.islice(itertools.count(), 100):
        observer.observe(Sample(START + step * SECOND, CLOCK, 0.0))
    assert all(tick % (7 * SECOND) == 0 for tick in ticks)
    assert len(ticks) == 14


def test_a_flood_within_one_window_is_bounded_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robophm.monitoring.monitor, "MOST_PENDING", 100)
    observer = Monitor(robophm.load(OTA))
    for i in range(1000):  # stamps that stand still
        observer.observe(Sample(START, "/ota/power/temperature.temperature", float(i % 40)))
    assert len(observer.ledger.pending) == 100
    assert sum(observer.ledger.counts.values()) == 900
    for i in range(1000):  # time goes on: the window is integrated before its period is over
        observer.observe(Sample(START + i * SECOND // 10, "/ota/power/temperature.temperature", 30.0))
    assert len(observer.ledger.pending) <= 100
    assert observer.ledger.integrated_to is not None
