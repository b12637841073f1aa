"""A recording that is known to have ended does not run on; one that goes on in the next file does, without a seam."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest

import robophm
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import kept_ledger, replay
from robophm.stores.memory import MemoryStore
from robophm.transports.recordings.journal import Journal
from robophm.transports.synthetic import SyntheticOta

START = 1_700_000_040 * SECOND
DESIGN = """
schema_version: 1
name: R
max_gap: 60 s
signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 10 s, range: [-40, 125]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""


@pytest.fixture
def design() -> Robot:
    return parse(DESIGN)


@pytest.fixture(scope="module")
def ota() -> Robot:
    return robophm.load(Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml")


def csv(path: Path, begin: int, seconds: int) -> Path:
    rows = [f"{(START + (begin + i) * SECOND) / SECOND:.0f},{35}" for i in range(seconds + 1)]
    path.write_text("\n".join(["time,/motor.temperature", *rows]) + "\n")
    return path


def bags(folder: Path, gap: int, count: int = 6, seed: int = 3) -> list[Path]:
    """So many bags of 60 s, and so many seconds between them."""
    return [
        SyntheticOta(
            seed=seed, start=START + i * (60 + gap) * SECOND, duration=60 * SECOND, working_hours=(0, 24)
        ).record(folder / f"{'qwerty'[i]}.mcap")
        for i in range(count)
    ]  # fmt: skip


def span(path: Path) -> float:
    with robophm.open_source(path) as source:
        infos = source.topics()
    return (max(info.last for info in infos if info.last) - min(info.first for info in infos if info.first)) / SECOND


@pytest.mark.parametrize("gap", [61, 600, 3600])
def test_six_bags_of_a_minute_count_six_minutes(ota: Robot, tmp_path: Path, gap: int) -> None:
    paths = bags(tmp_path, gap)
    assert replay(ota, paths).clocks["operating"] * 3600 == pytest.approx(sum(map(span, paths)), abs=0.01)


def test_each_way_to_go_through_them_gives_the_same(ota: Robot, tmp_path: Path) -> None:
    """At once, one by one into a store, as one source, and one by one through a monitor: bit for bit."""
    paths = bags(tmp_path, 200, count=3)
    at_once, apart, as_one = MemoryStore(), MemoryStore(), MemoryStore()
    report = replay(ota, list(reversed(paths)), store=at_once)
    for path in paths:
        replay(ota, path, store=apart)
    with robophm.open_source(*paths) as source:
        replay(ota, source, store=as_one)
    assert at_once.ledger(ota.name) == apart.ledger(ota.name) == as_one.ledger(ota.name)
    monitor = Monitor(ota, period=60)
    for path in paths:
        with robophm.open_source(path) as source:
            infos = source.topics()
            monitor.resume(min(info.first for info in infos if info.first))
            for sample in source.samples(ota.signals):
                monitor.observe(sample)
            monitor.end(max(info.last for info in infos if info.last))
    assert monitor.report().clocks == report.clocks
    kept = at_once.ledger(ota.name)
    assert kept is not None
    assert monitor.ledger.to_json()["totals"] == kept["totals"]


@pytest.mark.parametrize("gap", [1, 59])
def test_a_split_recording_has_no_seam(ota: Robot, tmp_path: Path, gap: int) -> None:
    """What goes on within max_gap is one drive, as if it were one file."""
    paths = bags(tmp_path, gap, count=3)
    with robophm.open_source(*paths) as source:
        samples = list(source.samples(ota.signals))
        last = max(info.last for info in source.topics() if info.last)
    monitor = Monitor(ota, period=60)
    for sample in samples:
        monitor.observe(sample)
    monitor.end(last)
    whole = monitor.report().clocks
    assert replay(ota, paths).clocks == whole
    assert whole["operating"] * 3600 == pytest.approx((last - samples[0].time) / SECOND, abs=1e-6)


@pytest.mark.parametrize("order", list(itertools.permutations(range(3)))[1:4])
def test_a_seam_a_night_and_any_order(design: Robot, tmp_path: Path, order: tuple[int, ...]) -> None:
    """0 to 100 s, within max_gap 110 to 210 s, and 600 to 700 s on its own: on for 210 s and 100 s."""
    paths = [csv(tmp_path / f"{i}.csv", begin, 100) for i, begin in enumerate((0, 110, 600))]
    report = replay(design, [paths[i] for i in order])
    assert report.clocks["operating"] * 3600 == pytest.approx(210 + 100, rel=1e-9)


def test_silence_within_a_recording_still_runs_on(design: Robot, tmp_path: Path) -> None:
    path = tmp_path / "one.csv"
    rows = [(START // SECOND + at, 35) for at in (*range(100), *range(600, 700))]
    path.write_text("\n".join(["time,/motor.temperature", *(f"{at},{value}" for at, value in rows)]) + "\n")
    assert replay(design, path).clocks["operating"] * 3600 == pytest.approx(99 + 60 + 99, rel=1e-9)


def test_a_run_that_goes_on_where_recordings_ended(design: Robot, tmp_path: Path) -> None:
    """Live, and replayed from its journal: bit for bit, and what was recorded before does not run on."""
    recorded = csv(tmp_path / "before.csv", 0, 100)
    kept, again = MemoryStore(), MemoryStore()
    replay(design, recorded, store=kept, period=1.0)
    replay(design, recorded, store=again, period=1.0)
    live = Monitor(design, kept_ledger(design, kept), period=1.0)
    with Journal(tmp_path / "run.journal", design.signals) as journal:
        for second in range(1000, 1200):
            signal = "/motor.temperature" if second < 1050 else CLOCK
            sample = Sample(START + second * SECOND, signal, 35.0)
            journal.write(sample)
            live.observe(sample)
    report = replay(design, tmp_path / "run.journal", store=again, period=1.0)
    assert again.ledger("R") == json.loads(json.dumps(live.ledger.to_json()))
    assert report.clocks["operating"] * 3600 == pytest.approx(
        100 + 49 + 60, rel=1e-9
    )  # what is live runs until max_gap
