"""A sample of a signal of wear as it comes live, into readings that are NumPy's, and a forecast by long courses."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks import Line, agree, benchmark
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_watch import WearWatch

PARTS, MINUTES = 20, 10
READINGS, TEACHERS = 1000, 50
START = 1_700_000_040 * SECOND

DESIGN = "schema_version: 1\nname: worn\ncomponents:\n" + "".join(
    f"  p{i}: {{rate: 20 FPMH, wear: {{topic: /wear, field: p{i}, every: 60 s, threshold: 9}}}}\n" for i in range(PARTS)
)


def course() -> tuple[np.ndarray, list[Sample]]:
    """Ten minutes of samples that rise to half of their thresholds, each part's every second; as a table, in order."""
    rng = np.random.default_rng(1)
    seconds = np.arange(60 * MINUTES)
    values = 4.5 * seconds[:, None] / len(seconds) + 0.1 * rng.standard_normal((len(seconds), PARTS))
    rows = enumerate(values.tolist())
    return values, [Sample(START + k * SECOND, f"/wear.p{i}", one) for k, row in rows for i, one in enumerate(row)]


def taken(monitor: Monitor, samples: Sequence[Sample]) -> float:
    """Mean of the seconds of a processor until the monitor had taken a sample in."""
    begun = time.thread_time()
    for sample in samples:
        monitor.observe(sample)
    return (time.thread_time() - begun) / len(samples)


def crack(life: float, until: float, rng: np.random.Generator) -> Unit:
    """A unit that grows as a crack does to 1 at the end of its life, with so many readings."""
    times = np.linspace(0.0, until, READINGS)
    return Unit(times, 0.1 / (1 - 0.9 * times / life) + 0.001 * rng.standard_normal(READINGS))


@benchmark
def long_courses() -> Iterator[Line]:
    rng = np.random.default_rng(2)
    mine = crack(1000.0, 700.0, rng)
    others = [crack(life, 1.02 * life, rng) for life in 1000 * np.exp(0.1 * rng.standard_normal(TEACHERS))]
    for name, teachers in (("alone", ()), (f"with {TEACHERS} others of as many", others)):
        begun = time.process_time()
        said = forecast_among(teachers, mine.times, mine.values, 1.0).remaining
        took = time.process_time() - begun
        agree(f"what is left, {name}", [said.low <= 300 <= said.high], [1.0], 0.0)
        yield Line(f"a forecast of wear by {READINGS:,} readings, {name} (of a processor)", took)


@benchmark
def live_reading() -> Iterator[Line]:
    values, samples = course()
    robot = parse(DESIGN)
    monitor = Monitor(robot, period=1.0)  # each sample is in its reading a second later
    alone = taken(monitor, samples)
    settled = monitor.exposure.settled(monitor.ledger)
    for i, mode in enumerate(robot.modes):
        assert mode.wear
        read = settled.wear[mode.key].readings(mode.wear)
        agree(f"readings of p{i}", read.values, values[:, i].reshape(MINUTES, 60).mean(axis=1), 1e-9)
    work = f"a live sample of wear into its reading, {PARTS} worn parts (of a processor)"
    yield Line(work, alone, per_second=f"{1 / alone:.2g} samples/s")
    watching = WearWatch(robot)
    watching.renew_soon(monitor.ledger)
    later = [sample._replace(time=sample.time + 60 * MINUTES * SECOND) for sample in samples]
    yield Line(f"{work}, while wear is foretold", taken(monitor, later))
    watching.close()
