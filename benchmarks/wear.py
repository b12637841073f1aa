"""A sample of a signal of wear as it comes live, into readings that are NumPy's, also while wear is foretold."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

import numpy as np

from benchmarks import Line, agree, benchmark
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_watch import WearWatch

PARTS, MINUTES = 20, 10
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
    """Mean of the seconds until the monitor had taken a sample in."""
    begun = time.perf_counter()
    for sample in samples:
        monitor.observe(sample)
    return (time.perf_counter() - begun) / len(samples)


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
    work = f"a live sample of wear into its reading, {PARTS} worn parts"
    yield Line(work, alone, per_second=f"{1 / alone:.2g} samples/s")
    watching = WearWatch(robot)
    watching.renew_soon(monitor.ledger)
    later = [sample._replace(time=sample.time + 60 * MINUTES * SECOND) for sample in samples]
    yield Line(f"{work}, while wear is foretold", taken(monitor, later))
    watching.close()
