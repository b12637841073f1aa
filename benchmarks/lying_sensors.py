"""``python -m benchmarks.lying_sensors FOLDER``: are sensors that lie found, and true ones left alone, on real signals?

FOLDER holds tables that others measured, as they publish them: ``testing.csv`` of "Appliances energy prediction"
(Candanedo, Feldheim and Deramaix, *Energy and Buildings* 140, 2017: nine rooms of a house and the air outside over 137
days, some 36 readings of each a day) and of the Numenta Anomaly Benchmark
``ambient_temperature_system_failure.csv`` (an office, hourly for a year) and
``machine_temperature_system_failure.csv`` (a large machine, every five minutes for 80 days, with its failures
labelled). What is not there is said and left out.

Each signal drives a part of a design and goes sample by sample through the monitor; once a day it is asked which
signals are doubtful. Faults are put into one signal at a time, from a day that a fixed seed draws.
"""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.doubtful_signals import doubtful_signals
from robophm.health.ledger import Ledger
from robophm.monitoring.monitor import Monitor

Array = npt.NDArray[np.float64]
Fault = Callable[[Array, Array, np.random.Generator], Array]
"""A fault, by the days since it began and what the sensor would have said; shapes (samples,)."""

DAY = 24 * HOUR
ROOMS = {f"T{i}": f"room_{i}" for i in (1, 2, 3, 4, 5, 7, 8, 9)}
SETTLED = 40
"""Days of a true past before a fault begins."""

FAULTS: Mapping[str, Fault] = {
    "10 K too high": lambda days, true, random: true + 10,
    "10 K too low": lambda days, true, random: true - 10,
    "5 K too high": lambda days, true, random: true + 5,
    "5 K too low": lambda days, true, random: true - 5,
    "drifts by 0.1 K a day": lambda days, true, random: true + 0.1 * days,
    "drifts by 0.3 K a day": lambda days, true, random: true + 0.3 * days,
    "stands still": lambda days, true, random: np.full(len(true), true[0]),
    "gain 1.2": lambda days, true, random: 1.2 * true,
    "gain 1.5": lambda days, true, random: 1.5 * true,
    "noise of 3 K": lambda days, true, random: true + random.normal(0, 3, len(true)),
    "noise of 10 K": lambda days, true, random: true + random.normal(0, 10, len(true)),
}


@dataclass(frozen=True)
class Course:
    """Signals of one past, each with its times [ns since the epoch], ascending, and values [°C]; shapes (samples,)."""

    times: npt.NDArray[np.int64]
    values: Mapping[str, Array]

    def flagged(self, robot: Robot, ledger: Ledger | None = None) -> Iterator[tuple[int, tuple[str, ...]]]:
        """Yield after each day its end [ns since the epoch] and the names of the signals that are doubtful by then."""
        monitor = Monitor(robot, period=3600, ledger=ledger)
        due = int(self.times[0]) + DAY
        for i, time in enumerate(self.times.tolist()):
            if time >= due:
                found = doubtful_signals(monitor.exposure, monitor.exposure.settled(monitor.ledger))
                yield due, tuple(one.signal.strip("/").partition(".")[0] for one in found)
                due += DAY
            self._heard(monitor, i, time)

    def ledger(self, robot: Robot) -> Ledger:
        """Return the ledger of a robot that went through the whole course."""
        monitor = Monitor(robot, period=3600)
        for i, time in enumerate(self.times.tolist()):
            self._heard(monitor, i, time)
        return monitor.ledger

    def _heard(self, monitor: Monitor, i: int, time: int) -> None:
        for name, values in self.values.items():
            if np.isfinite(values[i]):
                monitor.observe(Sample(time, f"/{name}.c", float(values[i])))

    def cut(self, time: int) -> tuple[Course, Course]:
        """Return what came before a time, and what since."""
        at = int(np.searchsorted(self.times, time))
        before, since = (
            Course(self.times[part], {name: values[part] for name, values in self.values.items()})
            for part in (slice(at), slice(at, None))
        )
        return before, since

    def with_fault(self, name: str, fault: Fault, random: np.random.Generator) -> Course:
        """Return the course with a fault of one signal from its beginning on."""
        days = (self.times - self.times[0]) / DAY
        return replace(self, values={**self.values, name: fault(days, self.values[name], random)})


@dataclass(frozen=True)
class Found:
    """What is told of a fault."""

    after: float | None
    """Days after which the signal was doubtful; None: never."""
    wrong: bool
    """Whether another signal was, at any time until then."""


def told_of(true: Course, name: str, seed: int) -> dict[str, Found]:
    """Return by each fault what is told of it in a signal that has told the truth for ``SETTLED`` days and more."""
    random = np.random.default_rng(seed)
    robot = design(list(true.values))
    before, since = true.cut(int(true.times[0]) + SETTLED * DAY + round(random.uniform(0, DAY)))
    ledger = before.ledger(robot)
    found = {}
    for kind, fault in FAULTS.items():
        after, wrong = None, False
        for time, names in since.with_fault(name, fault, random).flagged(robot, ledger.copy()):
            wrong = wrong or any(each != name for each in names)
            if name in names:
                after = (time - int(since.times[0])) / DAY
                break
        found[kind] = Found(after, wrong)
    return found


def table(path: Path, time: str, columns: Mapping[str, str], fahrenheit: bool = False) -> Course:
    """Read a table; ``columns`` maps its names to those of signals. Raises OSError, KeyError or ValueError."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    stamps = [datetime.fromisoformat(row[time]).replace(tzinfo=UTC) for row in rows]
    times = np.array([round(one.timestamp()) * SECOND for one in stamps], dtype=np.int64)
    order = np.flatnonzero(np.diff(times, prepend=times[0] - 1) > 0)
    values = {name: np.array([float(row[column]) for row in rows]) for column, name in columns.items()}
    values = {name: (one - 32) / 1.8 if fahrenheit else one for name, one in values.items()}
    return Course(times[order], {name: one[order] for name, one in values.items()})


def design(names: Sequence[str]) -> Robot:
    """Return a robot of equal parts, each with a temperature of its own."""
    parts = {
        name: {
            "rate": "1e-5 /h",
            "acceleration": {"model": "q10"},
            "signals": {"temperature": {"topic": f"/{name}", "field": "c", "max_age": "4 h"}},
        }
        for name in names
    }
    return parse(json.dumps({"schema_version": 1, "name": "R", "max_gap": "30 h", "components": parts}))


def main(folder: Path) -> None:
    """Print how often true signals are doubted, and which faults are found."""
    house = table(folder / "testing.csv", "date", ROOMS)
    report(house, "the house")


def report(true: Course, words: str) -> None:
    days = [names for _, names in true.flagged(design(list(true.values)))]
    flagged = sum(map(len, days))
    print(
        f"{words}: {flagged} of {len(days) * len(true.values)} days of {len(true.values)} signals doubtful, as they are"
    )
    found = [told_of(true, name, seed) for seed, name in enumerate(true.values)]
    for kind in FAULTS:
        each = [one[kind] for one in found]
        after = sorted(one.after for one in each if one.after is not None)
        middle = f", after {after[len(after) // 2]:.0f} days (median)" if after else ""
        wrong = sum(one.wrong for one in each)
        print(f"  {kind:22} {len(after)} of {len(each)} found{middle}; another signal named in {wrong}", flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
