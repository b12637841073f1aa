"""A clock that jumps ahead for a while ends no store: what it says is set aside and named, and time goes on."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.robot import Robot
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.live_loop import watch
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.transports.signals.source import SignalColumns, SignalSource, TopicInfo

from .designs import IN_2038, MEASURED, MOTOR, robot
from .designs import MEASURED_AS as T

START = 1_795_000_000 * SECOND


@pytest.fixture
def design() -> Robot:
    return robot(**MEASURED, components={**MOTOR, "shelf": {"rate": "0.001 /h", "clock": "calendar"}})


class Said(SignalSource):
    """Samples in the order of their arrival."""

    def __init__(self, samples: Sequence[Sample]) -> None:
        self.fingerprint = str(hash(tuple(samples)))
        self._samples = samples
        self.notes = Counter()

    def topics(self) -> list[TopicInfo]:
        times = [sample.time for sample in self._samples]
        return [TopicInfo("/motor", "", len(times), min(times), max(times), ("temperature",))]

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        return iter(self._samples)


def run(begin: int, seconds: int, celsius: float = 35.0) -> list[Sample]:
    return [Sample(begin + second * SECOND, T, celsius) for second in range(seconds)]


RETURNS = [*run(START, 300), *run(IN_2038, 20, 99.0), *run(START + 320 * SECOND, 300)]
ENDS_THERE = [*run(START, 300), *run(START + 320 * SECOND, 300), *run(IN_2038, 20, 99.0)]


@pytest.mark.parametrize("samples", [RETURNS, ENDS_THERE], ids=["and returns", "at the end, as sorted by its time"])
def test_a_jump_ends_no_store(design: Robot, tmp_path: Path, samples: list[Sample]) -> None:
    store = MemoryStore()
    report = replay(design, Said(samples), store=store)
    assert report.clocks["calendar"] * 3600 == pytest.approx(619, rel=1e-9)
    assert any("jumped ahead" in note and "2038-01" in note and note.startswith("20 samples") for note in report.notes)
    later = replay(design, Said(run(START + HOUR, 100)), store=store)
    assert later.clocks["calendar"] * 3600 == pytest.approx(3600 + 99, rel=1e-9)
    assert any("20 samples not taken: the clock had jumped ahead, to 2038-01: /motor" in note for note in later.notes)
    assert not any("late" in note for note in later.notes)


BACK = [*run(START, 300), *run(START - HOUR, 20), *run(START + 300 * SECOND, 300)]
"""A clock that is set back by an hour, for twenty samples."""


@pytest.mark.parametrize(
    ("samples", "wrong", "named"),
    [
        (RETURNS, range(300, 320), "the clock had jumped ahead, to 2038-01: /motor"),
        (BACK, range(300, 320), "late: /motor.temperature"),
    ],
    ids=["2038 for 20 s", "an hour back for 20 s"],
)
def test_a_recording_counts_as_if_the_wrong_samples_were_not_there(
    design: Robot, samples: list[Sample], wrong: range, named: str
) -> None:
    """Bit for bit, but for how many they were."""
    ledgers = []
    for heard in (samples, samples[: wrong.start] + samples[wrong.stop :]):
        monitor = Monitor(design)
        for sample in heard:
            monitor.observe(sample)
        ledgers.append(monitor.ledger.to_json())
    counts = [ledger.pop("counts") for ledger in ledgers]
    assert ledgers[0] == ledgers[1]
    assert [sum(count.values()) for count in counts] == [20, 0]
    assert named in " ".join(counts[0])


def test_watching_goes_on_through_a_jump_and_says_so(design: Robot) -> None:
    said: list[str] = []
    store = MemoryStore()
    monitor = watch(design, Said(RETURNS), store=store, on_clock=said.append)
    assert monitor.report().clocks["calendar"] * 3600 == pytest.approx(619, rel=1e-9)
    assert [words.split(":")[0] for words in said] == [
        "the clock jumped ahead by 97,912 h", "the clock is right again"
    ]  # fmt: skip
    assert not [event for event in store.history(design.identity).events() if event.kind == "restart"]
    again = run(START + HOUR, 100)
    watch(design, Said(again), store=store)  # and it is not ahead of what is heard
    restarts = [event.time for event in store.history(design.identity).events() if event.kind == "restart"]
    assert restarts == [again[0].time]


def test_a_clock_that_goes_back_is_said_at_once(design: Robot) -> None:
    said: list[str] = []
    monitor = watch(design, Said(BACK), on_clock=said.append)
    assert said[0] == "the clock went back by 1.08 h: nothing counts until that time has passed"
    assert said[1:] == ["the clock is right again: what is heard counts"]
    assert "20 samples not taken: late: /motor.temperature" in monitor.report().notes


def test_what_stays_ahead_is_believed_and_nothing_of_it_is_lost(design: Robot) -> None:
    monitor = Monitor(design)
    for sample in (*run(START, 60), *run(IN_2038, 700)):
        monitor.observe(sample)
    clocks = monitor.report().clocks
    assert clocks["calendar"] * 3600 == pytest.approx((IN_2038 - START) / SECOND + 699, rel=1e-12)
    assert clocks["operating"] * 3600 == pytest.approx(59 + 60 + 699, rel=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_by_the_column_as_one_by_one(design: Robot, seed: int) -> None:
    """Random jumps of random length, in random blocks: the ledger is the same bit for bit."""
    chance = np.random.default_rng(seed)
    samples: list[Sample] = []
    now = START
    for _ in range(int(chance.integers(1, 8))):
        leap = int(chance.choice([0, 0, 500 * 24 * HOUR, IN_2038 - START]))
        for _ in range(int(chance.integers(1, 900))):
            now += int(chance.integers(1, 2 * SECOND))
            value = float(chance.choice([35.0, 45.0, np.nan], p=[0.6, 0.39, 0.01]))
            samples.append(Sample(now + leap + int(chance.integers(-SECOND, SECOND)), T, value))
    monitor = Monitor(design)
    for sample in samples:
        monitor.observe(sample)
    life = BlockMonitor(Monitor(design))
    arrived = np.arange(len(samples), dtype=np.int64)
    times, values = (np.array([sample[i] for sample in samples]) for i in (0, 2))
    cuts = np.sort(chance.integers(0, len(samples), 5))
    for rows in np.split(np.arange(len(samples)), cuts):
        life.observe({T: SignalColumns(arrived[rows], times[rows], values[rows])})
        life._go_on()
    life.finish()
    one, other = (json.dumps(each.to_json(), sort_keys=True) for each in (monitor.ledger, life.ledger))
    assert one == other


def test_the_clock_of_silence_may_jump_too(design: Robot) -> None:
    monitor = Monitor(design)
    clock = [Sample(IN_2038 + second * SECOND, CLOCK, 0.0) for second in range(20)]
    for sample in (*run(START, 60), *clock, *run(START + 80 * SECOND, 60)):
        monitor.observe(sample)
    report = monitor.report()
    assert report.clocks["calendar"] * 3600 == pytest.approx(139, rel=1e-9)
    assert report.notes == ("no valid value for 11 s of operation: /motor.temperature",)
