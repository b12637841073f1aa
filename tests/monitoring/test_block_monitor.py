"""A life out of columns is the monitor's, sample by sample, bit for bit."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cases import examples

import robophm
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health import exposure
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.monitoring import block_monitor
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.monitoring.report_history import unheard
from robophm.stores.memory import MemoryStore
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals.source import SignalColumns
from robophm.transports.synthetic import SyntheticOta

OTA = Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml"
START = 1_700_000_040 * SECOND  # a whole minute
Arrivals = list[tuple[int, Sample]]


@cache
def shop(max_age: float, gap: float, stale: str, *, powered: bool) -> Robot:
    """Every kind of clock, one and two measured inputs, both scalings."""
    temperature = {"topic": "/a", "field": "t", "range": [-40, 125], "max_age": f"{max_age} s", "stale": stale}
    voltage = {"topic": "/b", "field": "v", "range": [0, 40], "max_age": f"{2 * max_age} s", "stale": stale}
    style = {"style": "CK", "capacitance": "1 uF", "temperature": "40 degC", "dc_voltage": "15 V"}
    capacitor = {"model": "mil_hdbk_217f.capacitor", "inputs": {**style, "rated_voltage": "50 V", "environment": "GB"}}
    wear = {"distribution": "weibull", "scale": "0.05 h", "shape": 2.5}
    infancy = {"distribution": "weibull", "scale": "0.02 km", "shape": 0.7}
    q10 = {"acceleration": {"model": "q10"}}
    kilometres = {"life": infancy, "clock": "kilometres", "scaling": "hazard", **q10}
    on_path = {"kilometres": {"topic": "/o", "position": ["x", "y"], "max_age": f"{max_age} s"}}
    on_speed = {"kilometres": {"topic": "/o", "speed": "v", "max_age": f"{max_age} s"}}
    design = {
        "schema_version": 1,
        "name": "shop",
        "components": {
            "plain": {"rate": "0.01 /h"},
            "capacitor": {"hazard": capacitor},
            "worn": {"life": wear, "clock": "calendar", **q10, "initial_exposure": "0.01 h"},
            "seal": {"life": wear, "scaling": "hazard", **q10},
            "tyre": {**kilometres, "clocks": on_speed},
            "track": {**kilometres, "clocks": on_path},
            "switch": {"rate": "1 /start", "clock": "starts", "clocks": {"starts": {"topic": "/s", "edge": "on"}}},
        },
        "clocks": on_path,
        "signals": {"temperature": temperature, "dc_voltage": voltage},
        "usage": {"kilometres": "2 km/h", "starts": "1 start/h"},
        "max_gap": f"{gap} s",
        **({"powered": {"topic": "/power", "field": "on"}} if powered else {}),
    }
    return parse(json.dumps(design))


def stepwise(robot: Robot, arrivals: Arrivals, period: float, step: int) -> tuple[Monitor, list[Any]]:
    """Sample by sample; and its ledger after the first end of a period in every step, and after those that follow
    until the robot is heard; and where that tells of none in a step, as it was heard last in it."""
    seen: list[Any] = []
    rests = Rests(step, seen)
    before: int | None = None
    silent = False

    def tick(monitor: Monitor) -> None:
        nonlocal before, silent
        now = monitor.ledger.integrated_to or 0
        if before is None or silent or now // step > before // step:
            seen.append(kept(monitor.ledger))
            on = monitor.ledger.last.get("/power.on", (0, (0.0,)))[1][0] > 0.5
            silent = monitor.ledger.heard is not None and now - monitor.ledger.heard > monitor.robot.max_gap and not on
        before = now
        rests.tick(monitor)

    monitor = Monitor(robot, period=period, on_tick=tick, on_rest=rests)
    for _, sample in arrivals:
        monitor.observe(sample)
    return monitor, seen


class Rests:
    """Ledgers of where a robot was heard last, of steps of which none was seen."""

    def __init__(self, step: int, seen: list[Any]) -> None:
        self.step, self.seen, self.known = step, seen, -1

    def tick(self, monitor: Monitor) -> None:
        if not unheard(monitor.robot, monitor.ledger):
            self.known = (monitor.ledger.integrated_to or 0) // self.step

    def __call__(self, monitor: Monitor, heard: int, then: Callable[[], Ledger]) -> None:
        if heard // self.step > self.known:
            self.known = heard // self.step
            self.seen.append(("rests", heard, kept(then())))


def in_order(state: Any) -> Any:
    """What is pending is in order of arrival with the one, of time with the other."""
    return {**state, "pending": sorted(state["pending"])}


def kept(ledger: Ledger) -> Any:
    state = ledger.to_json()
    for name in ("newest", "pending", "counts"):  # what arrives with the sample that ends a period may be in or not
        del state[name]
    return json.dumps(state, sort_keys=True)


def blocks(arrivals: Arrivals, sizes: Sequence[int]) -> Iterator[dict[str, SignalColumns]]:
    """By signal, cut anywhere between arrivals."""
    rest, sizes = arrivals, [*sizes, len(arrivals)]
    for size in sizes:
        while size < len(rest) and size and rest[size][0] == rest[size - 1][0]:
            size += 1
        part, rest = rest[:size], rest[size:]
        block = {}
        for signal in sorted({sample.signal for _, sample in part}):
            own = [(at, sample) for at, sample in part if sample.signal == signal]
            block[signal] = SignalColumns(
                np.array([at for at, _ in own]),
                np.array([sample.time for _, sample in own]),
                np.array([sample.value for _, sample in own]),
            )
        if block:
            yield block


def by_columns(
    robot: Robot, arrivals: Arrivals, period: float, step: int, sizes: Sequence[int]
) -> tuple[Monitor, list[Any]]:
    seen: list[Any] = []
    rests = Rests(step, seen)

    def tick(monitor: Monitor) -> None:
        seen.append(kept(monitor.ledger))
        rests.tick(monitor)

    monitor = Monitor(robot, period=period, on_tick=tick, on_rest=rests)
    life = BlockMonitor(monitor, step)
    for block in blocks(arrivals, sizes):
        life.observe(block)
    life.finish()
    return monitor, seen


def stream(seed: int, count: int, *, rough: bool) -> Arrivals:
    """What arrives: ties, gaps, what is no sample, and disorder within and beyond the window where it is rough."""
    chance = np.random.default_rng(seed)
    ranges = {"/a.t": (-60, 150), "/b.v": (-5, 45), "/o.v": (-3, 3), "/o.x": (-3, 3), "/o.y": (-3, 3)}
    found, now = [], START
    for _ in range(count):
        now += int(chance.choice([0, 1, SECOND // 10, SECOND, 20 * SECOND], p=[0.2, 0.1, 0.4, 0.25, 0.05]))
        if chance.random() < 0.005:
            now += int(chance.integers(0, 4000)) * SECOND
        signal = str(chance.choice([*ranges, "/s.on", "/power.on"]))
        low, high = ranges.get(signal, (0, 1))
        value = float(chance.uniform(low, high)) if signal in ranges else float(chance.integers(0, 2))
        if chance.random() < 0.03:
            value = float(chance.choice([np.nan, np.inf, 1e9, 20.0]))
        late = int(chance.choice([0, SECOND // 2, SECOND, 9 * SECOND, 70 * SECOND], p=[0.8, 0.1, 0.05, 0.03, 0.02]))
        found.append((now, Sample(now - late * rough, signal, value)))
    return sorted(found, key=lambda one: (one[0], one[1].signal))


@settings(max_examples=examples(60), deadline=None, derandomize=True, database=None)
@given(
    st.builds(stream, st.integers(0, 2**32), st.integers(1, 250), rough=st.booleans()),
    st.sampled_from([0.3, 5.0, 30.0]),
    st.sampled_from([0.5, 20.0, 60.0]),
    st.sampled_from(["conservative", "nominal", "hold", "worst"]),
    st.booleans(),
    st.sampled_from([3, 10, 60]),
    st.sampled_from([60 * SECOND, 600 * SECOND]),
    st.lists(st.integers(1, 200), max_size=5),
    st.sampled_from([1, 100, 10**6]),
    st.sampled_from([-1, 10**6]),
    st.sampled_from([1, 3, 1024]),
)
def test_a_life_out_of_columns_is_the_monitors_bit_for_bit(
    arrivals: Arrivals, max_age: float, gap: float, stale: str, powered: bool, period: int, step: int,
    sizes: list[int], enough: int, each: int, periods: int,
) -> None:  # fmt: skip
    robot = shop(max_age, gap, stale, powered=powered)
    expected, looks = stepwise(robot, arrivals, period, step)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(block_monitor, "ENOUGH", enough)
        patch.setattr(block_monitor, "PERIODS", periods)
        patch.setattr(exposure, "EACH", each)
        found, seen = by_columns(robot, arrivals, period, step, sizes)
    state, other = in_order(found.ledger.to_json()), in_order(expected.ledger.to_json())
    assert {key for key in state if state[key] != other[key]} == set()
    assert seen == looks
    assert found.report() == expected.report()


@pytest.mark.parametrize("bad", [(START + 200 * SECOND, np.nan), (START, 20.0)])
def test_a_block_of_nothing_but_bad_samples_is_counted(bad: tuple[int, float]) -> None:
    robot = shop(5.0, 20.0, "nominal", powered=False)
    time, value = bad
    arrivals = [(START + i * SECOND, Sample(START + i * SECOND, "/a.t", 20.0)) for i in range(200)]
    arrivals += [(START + i * SECOND, Sample(time, "/a.t", value)) for i in range(200, 220)]
    expected, _ = stepwise(robot, arrivals, 60, 60 * SECOND)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(block_monitor, "ENOUGH", 1)
        found, _ = by_columns(robot, arrivals, 60, 60 * SECOND, [200])
    assert sum(found.ledger.counts.values()) == 20
    assert found.ledger.to_json() == expected.ledger.to_json()


def test_long_silence_is_counted_to_the_nanosecond() -> None:
    """Beyond 2**53 ns, 104 days, a double would lose some."""
    robot = shop(0.3, 59.999999999, "nominal", powered=False)
    times = [START + i * 60 * SECOND for i in range(170_002)]  # on for all but the last nanosecond of each minute
    ledger = Ledger.new(robot)
    ledger.started = times[0]
    ExposureIntegrator(robot).integrate(ledger, [Sample(time, "/o.v", 1.0) for time in times], times[-1])
    on = 170_001 * (60 * SECOND - 1)
    assert on > 2**53
    assert ledger.stale["/a.t 1.0 0.0 -40.0 125.0"] == on
    assert ledger.stale["/o.v"] == on - 170_001 * 3 * SECOND // 10


class Samples(Recording):
    """A recording that is gone through sample by sample."""

    def columns(self, signals: Any, since: int) -> Any:
        """It has none."""
        return None


@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap"])
def test_a_recording_by_column_and_by_sample(tmp_path: Path, suffix: str) -> None:
    robot = robophm.load(OTA)
    path = SyntheticOta(seed=7, duration=7000 * SECOND).record(tmp_path / f"drive{suffix}")
    stores = MemoryStore(), MemoryStore()
    with Samples(path) as samples, Recording(path) as columns:
        reports = [replay(robot, source, store=store) for source, store in zip((samples, columns), stores, strict=True)]
    assert reports[0] == reports[1]
    assert in_order(stores[0].ledger(robot.name)) == in_order(stores[1].ledger(robot.name))
    assert list(stores[0].history(robot.name).reports()) == list(stores[1].history(robot.name).reports())
    assert len(list(stores[1].history(robot.name).reports())) > 10


@pytest.mark.parametrize("name", ["turtlesim.bag", "temperature.bag"])
def test_recordings_that_nobody_here_made(shared: Path, name: str) -> None:
    binding: dict[str, Any] = {"clocks": {"kilometres": {"topic": "/turtle1/pose", "position": ["x", "y"]}}}
    if name == "temperature.bag":
        binding = {"signals": {"temperature": {"topic": "/my_temperature", "field": "temperature"}}}
    part = {"rate": "0.01 /h", "acceleration": {"model": "q10"}}
    robot = parse(json.dumps({"schema_version": 1, "name": "R", "components": {"part": part}, **binding}))
    path = shared / "recordings" / name
    stores = MemoryStore(), MemoryStore()
    with Samples(path) as samples, Recording(path) as columns:
        reports = [replay(robot, source, store=store) for source, store in zip((samples, columns), stores, strict=True)]
    assert reports[0] == reports[1]
    assert in_order(stores[0].ledger("R")) == in_order(stores[1].ledger("R"))


def test_a_block_may_have_nothing_of_a_signal() -> None:
    """As where no message in it has the element that is asked for."""
    monitor = Monitor(shop(5, 60, "nominal", powered=False))
    life = BlockMonitor(monitor)
    nothing = SignalColumns(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
    for minute in range(5):
        times = START + (minute * 60 + np.arange(60)) * SECOND
        life.observe({"/a.t": SignalColumns(times, times, np.full(60, 30.0)), "/b.v": nothing})
    life.finish()
    assert monitor.report().clocks["calendar"] * 3600 == pytest.approx(299, rel=1e-12)


def test_a_flood_is_bounded_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stamps that stand still, then time that goes on: the open period is integrated before it is over."""
    monkeypatch.setattr(block_monitor, "MOST_WAITING", 500)
    monkeypatch.setattr(block_monitor, "ENOUGH", 100)
    monitor = Monitor(shop(5, 60, "nominal", powered=False))
    life = BlockMonitor(monitor, 600 * SECOND)

    def say(first: int, seconds: np.ndarray[Any, Any]) -> None:
        times = START + np.round(seconds * SECOND).astype(np.int64)
        arrived = START + first * SECOND + np.arange(len(times))
        life.observe({"/a.t": SignalColumns(arrived, times, np.full(len(times), 30.0))})

    say(0, np.arange(120) * 1.0)  # the first period is over
    say(120, np.full(2000, 120.0))
    dropped = monitor.ledger.counts["more than 500 within 1 s: /a.t"]
    assert dropped > 1400
    say(130, 120 + np.arange(1000) / 50)
    life.finish()
    assert monitor.ledger.integrated_to is not None
    assert monitor.ledger.integrated_to > START + 130 * SECOND
    assert len(monitor.ledger.pending) <= 500
    hours = monitor.report().clocks["calendar"]
    assert hours * 3600 == pytest.approx(120 + 999 / 50, rel=1e-12)
