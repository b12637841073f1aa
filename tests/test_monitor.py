"""The loop from samples to health: recordings, restarts, kills, silence and journals."""

from __future__ import annotations

import itertools
import json
import random
import subprocess
import sys
import time
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

import robophm
from robophm.core.errors import SourceError, StoreError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.monitor import Monitor, recording_key, replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.journal import Journal
from robophm.transports.synthetic import SyntheticOta

OTA = Path(__file__).parents[1] / "examples" / "ota" / "robot.yaml"
START = 1_700_000_040 * SECOND  # a whole minute


@pytest.fixture(scope="module")
def ota() -> Robot:
    return robophm.load(OTA)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Four minutes of the synthetic robot in the three formats, by suffix."""
    folder, drive = tmp_path_factory.mktemp("recorded"), SyntheticOta(seed=5, duration=240 * SECOND)
    return {suffix: drive.record(folder / f"drive{suffix}") for suffix in (".bag", ".db3", ".mcap")}


def robot(**design: Any) -> Robot:
    components = {"part": {"rate": "0.01 /h", "acceleration": {"model": "q10"}}}
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **design}))


def bound(topic: str, field: str, **more: Any) -> dict[str, Any]:
    return {"signals": {"temperature": {"topic": topic, "field": field, **more}}}


def exact(value: Any) -> Any:
    return pytest.approx(float(value), rel=1e-12, abs=0)


# One drive, many files.


def test_three_formats_are_one_drive(ota: Robot, recorded: dict[str, Path]) -> None:
    stores = {suffix: MemoryStore() for suffix in recorded}
    reports = [replay(ota, path, store=stores[suffix]).to_json() for suffix, path in recorded.items()]
    assert reports[0]["clocks"]["kilometres"] > 0
    assert reports[0] == reports[1] == reports[2]
    ledgers = [store.ledger(ota.name) for store in stores.values()]
    assert ledgers[0] == ledgers[1] == ledgers[2]
    assert ledgers[0]


def test_a_recording_is_counted_once_in_whatever_pieces(ota: Robot, recorded: dict[str, Path]) -> None:
    store = MemoryStore()
    first = replay(ota, recorded[".mcap"], store=store, period=20, report_every=60)
    kept, history = store.ledger(ota.name), list(store.history(ota.name))
    start = SyntheticOta(duration=SECOND).times[0]
    assert [(one["time"] - start) / SECOND for one in history] == [20, 60, 120, 180]  # the first, and every minute
    again = replay(ota, recorded[".mcap"], store=store, period=20, report_every=60)
    assert (again.to_json(), store.ledger(ota.name), list(store.history(ota.name))) == (first.to_json(), kept, history)


KILLED = """
import os, sys, time
import robophm, robophm.monitor
from robophm.stores.sqlite import SqliteStore
robophm.monitor.SAVE_EVERY = 0.01
def tick(monitor):
    time.sleep(0.002)
    os.write(1, b".")
robophm.replay(robophm.load(sys.argv[1]), sys.argv[2], store=SqliteStore(sys.argv[3]), period=1, report_every=10, on_tick=tick)
"""  # noqa: E501


def test_a_replay_killed_again_and_again_ends_as_one_that_was_not(
    ota: Robot, recorded: dict[str, Path], tmp_path: Path
) -> None:
    path, chance, progress = tmp_path / "killed.db", random.Random(4), []
    with robophm.open_source(recorded[".mcap"]) as source:
        key = recording_key(source, ota.signals)
    for _ in range(20):
        command = [sys.executable, "-c", KILLED, str(OTA), str(recorded[".mcap"]), str(path)]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as child:
            assert child.stdout
            child.stdout.read(chance.randint(20, 70))  # ticks
            time.sleep(chance.uniform(0, 0.01))
            child.kill()
            finished = child.wait() == 0
        with SqliteStore(path) as store:
            progress.append(store.progress(ota.name, key))
        if finished:
            break
    assert progress[-1].complete
    assert sum(one.samples > 0 and not one.complete for one in progress) >= 2  # killed on the way
    undisturbed = MemoryStore()
    expected = replay(ota, recorded[".mcap"], store=undisturbed, period=1, report_every=10)
    with SqliteStore(path) as store:
        assert store.ledger(ota.name) == undisturbed.ledger(ota.name)
        assert list(store.history(ota.name)) == list(undisturbed.history(ota.name))
        found = replay(ota, recorded[".mcap"], store=store, period=1, report_every=10)
        assert store.ledger(ota.name) == undisturbed.ledger(ota.name)
    assert found.to_json() == expected.to_json()


def test_a_store_of_another_design_is_refused(ota: Robot, recorded: dict[str, Path]) -> None:
    store = MemoryStore()
    replay(ota, recorded[".mcap"], store=store)
    other = parse(OTA.read_text(encoding="utf-8").replace("YSK-G", "YSK-H"))
    with pytest.raises(
        StoreError,
        match=r"ledger was kept for other parts: .Computation/YSK-G \(operating, age scaling\). is in it alone",
    ):
        replay(other, recorded[".mcap"], store=store)


def test_a_clock_that_came_to_be_measured_starts_then(ota: Robot, recorded: dict[str, Path]) -> None:
    """The parts are the same, so that their past goes on; the robot's own clocks are kept by their names."""
    text = OTA.read_text(encoding="utf-8")
    before = parse(text[: text.index("clocks:")] + text[text.index("thresholds:") :])
    store, whole = MemoryStore(), replay(ota, recorded[".mcap"]).clocks
    replay(before, recorded[".mcap"], store=store)
    after = replay(ota, recorded[".bag"], store=store).clocks  # the same drive: late, but for the open window
    assert after["operating"] == pytest.approx(whole["operating"], rel=1e-3)
    assert 0 < after["kilometres"] < whole["kilometres"]


# Recordings that nobody here made.


def raw(path: Path, topic: str) -> list[tuple[int, Any]]:
    """Receipt times and messages, straight from rosbags."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([path], default_typestore=get_typestore(Stores.ROS1_NOETIC)) as reader:
        chosen = [connection for connection in reader.connections if connection.topic == topic]
        return [(at, reader.deserialize(data, c.msgtype)) for c, at, data in reader.messages(connections=chosen)]


def test_turtle_drove_so_many_metres(shared: Path) -> None:
    pose = {"kilometres": {"topic": "/turtle1/pose", "position": ["x", "y"]}}
    report = replay(robot(clocks=pose), shared / "recordings" / "turtlesim.bag")
    assert round(1000 * report.clocks["kilometres"], 4) == 28.3520
    assert round(3600 * report.clocks["calendar"], 3) == 21.489
    poses = raw(shared / "recordings" / "turtlesim.bag", "/turtle1/pose")
    way = sum(mp.hypot(mpf(b.x) - mpf(a.x), mpf(b.y) - mpf(a.y)) for (_, a), (_, b) in pairwise(poses))
    assert report.clocks["kilometres"] == exact(way / 1000)


def test_temperature_as_it_was_received(shared: Path) -> None:
    """All header stamps are zero, so that the receipt times count."""
    path = shared / "recordings" / "temperature.bag"
    messages = raw(path, "/my_temperature")
    assert {message.header.stamp.sec for _, message in messages} == {0}
    store = MemoryStore()
    replay(robot(**bound("/my_temperature", "temperature")), path, store=store)
    report = replay(robot(**bound("/my_temperature", "temperature")), path)
    H = sum(
        mpf("0.01") * mpf(2) ** ((mpf(float(message.temperature)) - 25) / 10) * (until - at) / HOUR
        for (at, message), (until, _) in pairwise(messages)
    )
    assert report.system.sensor_based.unreliability == exact(-mp.expm1(-H))
    assert report.clocks["operating"] == exact(Fraction(messages[-1][0] - messages[0][0], HOUR))
    assert f"receipt time used for /my_temperature ({len(messages)} times)" in report.notes


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
    assert report.system.sensor_based.unreliability == exact(-mp.expm1(-mpf("0.01") * (15 * 2 + 55) / 3600))


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
    begun = time.perf_counter()
    for at in (0, 1, year, year + SECOND):
        observer.observe(Sample(START + at, T, 35.0))
    assert time.perf_counter() - begun < 1
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


def test_what_a_recording_lacks(recorded: dict[str, Path]) -> None:
    missing = robot(**bound("/ota/motility/temperature", "temperature"))
    with pytest.raises(SourceError, match=r"no topic '/ota/motility/temperature'.*/ota/mobility/temperature"):
        replay(missing, recorded[".mcap"])
    with pytest.raises(SourceError, match="none of the design's topics"):
        replay(missing, recorded[".mcap"], skip_missing=True)
    with pytest.raises(SourceError, match=r"no number 'temprature'.*temperature"):
        replay(robot(**bound("/ota/mobility/temperature", "temprature")), recorded[".mcap"])
    with pytest.raises(SourceError, match="voltage is in 'V'; the design expects 'degC'"):
        replay(robot(**bound("/ota/battery", "voltage")), recorded[".mcap"])


def test_one_missing_signal_stays_silent_if_that_is_wanted(recorded: dict[str, Path]) -> None:
    clock = {"kilometres": {"topic": "/ota/odom", "position": ["pose.pose.position.x", "pose.pose.position.y"]}}
    design = robot(**bound("/nowhere", "temperature"), clocks=clock)
    report = replay(design, recorded[".mcap"], skip_missing=True)
    assert report.system.flags == ("stale /nowhere.temperature",)
    assert report.system.sensor_based.reliability == report.system.nominal.reliability < 1


def test_ticks_are_whole_periods() -> None:
    ticks: list[int] = []
    observer = Monitor(robot(), period=7, on_tick=lambda monitor: ticks.append(monitor.ledger.integrated_to or 0))
    for step in itertools.islice(itertools.count(), 100):
        observer.observe(Sample(START + step * SECOND, CLOCK, 0.0))
    assert all(tick % (7 * SECOND) == 0 for tick in ticks)
    assert len(ticks) == 14


def test_a_recording_older_than_the_ledger_is_refused(ota: Robot) -> None:
    """Tuesday, then Monday: nothing of Monday could count, and nothing is marked as counted."""
    monday, tuesday = (
        SyntheticOta(start=START + day * 24 * HOUR, duration=600 * SECOND, working_hours=(0, 24)) for day in (0, 1)
    )
    store = MemoryStore()
    replay(ota, tuesday, store=store)
    before = store.ledger(ota.name)
    with pytest.raises(SourceError, match="would not count; expected recordings in the order of their time"):
        replay(ota, monday, store=store)
    assert store.ledger(ota.name) == before


def test_a_flood_within_one_window_is_bounded_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robophm.monitor, "MOST_PENDING", 100)
    observer = Monitor(robophm.load(OTA))
    for i in range(1000):  # stamps that stand still
        observer.observe(Sample(START, "/ota/power/temperature.temperature", float(i % 40)))
    assert len(observer.ledger.pending) == 100
    assert sum(observer.ledger.counts.values()) == 900
    for i in range(1000):  # time goes on: the window is integrated before its period is over
        observer.observe(Sample(START + i * SECOND // 10, "/ota/power/temperature.temperature", 30.0))
    assert len(observer.ledger.pending) <= 100
    assert observer.ledger.integrated_to is not None
