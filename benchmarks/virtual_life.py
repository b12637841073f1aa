"""A robot's life out of columns, against the monitor that takes the same samples one by one.

``python -m benchmarks.virtual_life`` lives through a whole year, with a store, and says what it took.
"""

from __future__ import annotations

import json
import resource
import tempfile
import time
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

import numpy as np

from benchmarks import DisagreementError, Line, agree, benchmark, race
from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.hazard.acceleration import BOLTZMANN
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals.source import SignalColumns, SignalSource, TopicInfo
from robophm.transports.synthetic import SyntheticOta

CHANNELS = 20
RATE = 10  # samples a second, of each channel
START = 1_700_000_000 * SECOND
YEAR = 365 * 24


def design() -> Robot:
    """100 parts in 20 modules, each module with a sensor and an acceleration model of its own."""
    models = [
        f"{{model: arrhenius, reference_temperature: 25 degC, activation_energy: {0.4 + channel / 50} eV}}"
        if channel % 2
        else f"{{model: q10, reference_temperature: 25 degC, q: {1.5 + channel / 20}}}"
        for channel in range(CHANNELS)
    ]
    lines = ["schema_version: 1", "name: year", "modules:"]
    for channel, model in enumerate(models):
        binding = f"{{topic: /t{channel}, field: temperature, unit: degC, range: [-40, 125]}}"
        lines += [f"  M{channel}:", f"    signals: {{temperature: {binding}}}", f"    acceleration: {model}"]
        lines += ["    components:", *(f"      P{part}: {{rate: {1e-6 * (part + 1)} /h}}" for part in range(5))]
    return parse("\n".join(lines))


class Hours(SignalSource):
    """So many hours of every channel, made as they are asked for."""

    def __init__(self, hours: float) -> None:
        self.hours = hours
        self.fingerprint = f"{hours} hours"
        self.notes = Counter()
        self._noise = np.random.default_rng(1).normal(0, 0.1, 200_000)

    def topics(self) -> list[TopicInfo]:
        """One of each channel."""
        end, count = START + round(self.hours * HOUR), round(self.hours * 3600 * RATE)
        return [TopicInfo(f"/t{i}", "", count, START, end, ("temperature",)) for i in range(CHANNELS)]

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]]:
        """An hour in a block."""
        step, chance = SECOND // RATE, np.random.default_rng(2)
        for hour in range(int(np.ceil(self.hours))):
            count = round(min(1.0, self.hours - hour) * 3600 * RATE)
            times = START + hour * HOUR + np.arange(count) * step
            block = {}
            for i in range(CHANNELS):
                begin = int(chance.integers(0, len(self._noise) - count))
                heat = 27 + 8 * np.sin(2 * np.pi * (hour / 24 + i / CHANNELS))
                own = times + i * 1000
                block[f"/t{i}.temperature"] = SignalColumns(own, own, heat + self._noise[begin : begin + count])
            yield block

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The same, one by one."""
        for block in Hours.columns(self, signals, 0):
            rows = zip(*(heard.times.tolist() for heard in block.values()), strict=True)
            values = zip(*(heard.values.tolist() for heard in block.values()), strict=True)
            for at, said in zip(rows, values, strict=True):
                for time_, signal, value in zip(at, block, said, strict=True):
                    yield Sample(time_, signal, value)


class OneByOne(Hours):
    """The same without columns."""

    def columns(self, signals: Collection[str], since: int) -> None:  # type: ignore[override]
        """It has none."""


class Samples(Recording):
    """A recording that is decoded message by message."""

    def columns(self, signals: Collection[str], since: int) -> None:  # type: ignore[override]
        """It has none."""


def same(robot: Robot, columns: SignalSource, samples: SignalSource) -> None:
    """Raise DisagreementError where the ledgers differ in a single bit."""
    stores = MemoryStore(), MemoryStore()
    for source, store in zip((columns, samples), stores, strict=True):
        replay(robot, source, store=store)
    found, expected = (dict(store.ledger(robot.name) or {}) for store in stores)
    for state in (found, expected):
        state["pending"] = sorted(state["pending"])
    if json.dumps(found, sort_keys=True) != json.dumps(expected, sort_keys=True):
        raise DisagreementError("the ledgers differ")


def lived(robot: Robot, hours: float) -> Monitor:
    """By the column, without the report at the end of a replay."""
    life = BlockMonitor(Monitor(robot))
    for block in Hours(hours).columns((), 0):
        life.observe(block)
    life.finish()
    return life.monitor


def bare(hours: float, until: int = START + YEAR * HOUR) -> list[float]:
    """What no integrator can do without, in NumPy: each formula by hand, how long a value holds, sums by the minute.

    Gives the effective hours of each channel's parts. Nothing is checked: no range, no order, no silence.
    """
    hours_of, minute = [0.0] * CHANNELS, np.arange(0, 3600 * RATE, 60 * RATE)
    for block in Hours(hours).columns((), 0):
        for channel, (_, times, values) in enumerate(block.values()):
            if channel % 2:
                kelvin = (0.4 + channel / 50) / BOLTZMANN
                factor = np.exp(kelvin / 298.15 - kelvin / (values + 273.15))
            else:
                factor = np.exp(np.log(1.5 + channel / 20) / 10 * (values - 25))
            held = np.empty(len(times))
            np.subtract(times[1:], times[:-1], out=held[:-1])
            held[-1] = SECOND // RATE
            if times[-1] >= until:
                held = np.clip(until - times, 0, held)
            sums = np.add.reduceat(factor * held, minute[minute < len(times)])
            hours_of[channel] += float(sums.sum()) / HOUR
    return hours_of


@benchmark
def channels() -> Iterator[Line]:
    """Samples in memory."""
    robot, hours = design(), 24.0
    same(robot, Hours(0.4), OneByOne(0.4))
    ledger = lived(robot, 0.4).ledger
    agree("effective hours", ledger.effective.value[::5], bare(0.4, ledger.integrated_to or 0), 1e-7)
    few, count = 0.1, CHANNELS * RATE * 3600

    def one_by_one() -> None:
        monitor = Monitor(robot)
        for sample in Hours(few).samples(()):
            monitor.observe(sample)

    ours, theirs, least = race(lambda: lived(robot, hours), one_by_one, lambda: bare(hours), rounds=5, at_least=0.0)
    rate = f"{hours * count / ours / 1e6:.1f} M samples/s"
    work = f"{hours:g} h, {CHANNELS} channels at {RATE} Hz, 100 parts"
    yield Line(work, ours, theirs * hours / few, "its own monitor, sample by sample, extrapolated", 1 / 200, rate)
    yield Line(work, ours, least, "the formulas alone in NumPy, nothing checked")


@benchmark
def recording() -> Iterator[Line]:
    """A file, as users have it."""
    robot = parse((Path(__file__).parents[1] / "examples" / "ota" / "robot.yaml").read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        path = SyntheticOta(seed=1).record(Path(folder) / "day.mcap")
        with Recording(path) as columns, Samples(path) as samples:
            same(robot, columns, samples)
            ours, theirs = race(lambda: replay(robot, columns), lambda: replay(robot, samples), rounds=3, at_least=0.0)
    yield Line("a day's .mcap, 345,600 messages", ours, theirs, "its own monitor, message by message", 1 / 200)


def main() -> None:
    robot = design()
    same(robot, Hours(0.4), OneByOne(0.4))
    with tempfile.TemporaryDirectory() as folder, SqliteStore(Path(folder) / "year.db") as store:
        begun = time.perf_counter(), time.process_time()
        report = replay(robot, Hours(YEAR), store=store)
        wall, cpu = time.perf_counter() - begun[0], time.process_time() - begun[1]
        kept, reports = (Path(folder) / "year.db").stat().st_size, len(list(store.history(robot.name).reports()))
    count = YEAR * 3600 * RATE * CHANNELS
    print(
        f"{count:,} samples, {report.clocks['operating']:,.2f} h, reliability {report.system.sensor_based.reliability}"
    )
    print(f"{wall / 60:.1f} minutes, {cpu / 60:.1f} of one core, {count / wall / 1e6:.1f} M samples/s")
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB")
    print(f"store {kept / 1e6:.1f} MB, {reports} reports")


if __name__ == "__main__":
    main()
