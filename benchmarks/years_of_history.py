"""``python -m benchmarks.years_of_history``: ten years of one report a minute in a store, and what it takes to read.

The reports are the arm's, as the engine gives them at ages up to so many years and at many temperatures; every minute
has one of them with its figures moved a little, so that no two are alike. They are saved through the store's own
``save``, four weeks at a time, which leaves the same as one by one (``tests/stores/test_history.py``).
"""

from __future__ import annotations

import argparse
import json
import random
import resource
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor
from robophm.stores.sqlite import SqliteStore

DESIGN = Path(__file__).parents[1] / "examples" / "arm" / "robot.yaml"
BEGIN = 1_577_836_800 * SECOND  # 2020-01-01
MINUTE = 60 * SECOND
YEAR = 365 * 24 * 60
"""Reports in a year."""


def looks(years: float, count: int) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Reports of the arm, and its ledger, as JSON, so many over so many years."""
    robot, draw = load(DESIGN), random.Random(48)
    monitor = Monitor(robot, period=3600.0)
    step = round(years * YEAR / count) * MINUTE
    for i in range(count):
        at = BEGIN + i * step
        for time_ in (*range(at, at + step - HOUR, max(step // 4, MINUTE)), at + step - SECOND):
            for signal in robot.signals:
                monitor.observe(Sample(time_, signal, draw.uniform(20, 60)))
        report = monitor.report(remaining_life="robot", wear=())
        yield report.to_json(failures_to_come=False), monitor.ledger.to_json()


def minute(report: dict[str, Any], time_: int, draw: random.Random) -> dict[str, Any]:
    """A report at another time, the robot's figures moved by up to a thousandth."""
    robot = report["subjects"][0]
    moved = dict(robot)
    for view in ("nominal", "sensor_based"):
        figures = moved[view] = dict(robot[view])
        for name in ("hazard_rate", "unreliability"):
            figures[name] = figures[name] * draw.uniform(0.999, 1.001)
    return {**report, "time": time_, "subjects": [moved, *report["subjects"][1:]]}


def make(path: Path, years: float) -> None:
    """Make the store, through ``save``."""
    begun, count, batch = time.process_time(), round(years * YEAR), 28 * 24 * 60
    found = list(looks(years, max(2, round(years * 50))))
    draw = random.Random(1)
    with SqliteStore(path) as store:
        for first in range(0, count, batch):
            report, ledger = found[first * len(found) // count]
            times = range(BEGIN + first * MINUTE, BEGIN + min(first + batch, count) * MINUTE, MINUTE)
            store.save(report["robot"], ledger, (), [minute(report, at, draw) for at in times])
            if first // batch % 13 == 0:
                print(f"{first / YEAR:.0f} of {years:g} years", file=sys.stderr, flush=True)
    size = path.stat().st_size
    print(f"made {count:,} reports in {time.process_time() - begun:,.0f} s of a processor")
    print(f"size {size / 1e6:,.1f} MB, {size / 1e6 / years:,.1f} MB a year")


def windows(path: Path, years: float, count: int = 200) -> None:
    """Time so many windows of every length, from minutes to all."""
    draw, took, used = random.Random(2), [], []
    total = years * YEAR * MINUTE
    with SqliteStore(path) as store:
        for _ in range(count):
            length = round(10 ** draw.uniform(np.log10(10 * MINUTE), np.log10(total)))
            start = BEGIN + round(draw.uniform(0, total - length))
            begun, work = time.perf_counter(), time.process_time()
            found = store.history("arm").figures(start, start + length)
            json.dumps(found.to_json())
            store.history("arm").events(start, start + length)
            took.append(1000 * (time.perf_counter() - begun))
            used.append(1000 * (time.process_time() - work))
            assert 0 < len(found.times) <= 1000
    for words, each in (("by the clock", took), ("of a processor", used)):
        p50, p99, most = np.percentile(each, [50, 99, 100])
        print(f"{count} windows, as JSON with their events, {words}: p50 {p50:.1f} ms, p99 {p99:.1f}, most {most:.1f}")


def command(path: Path, *words: str) -> None:
    """Time a command in a process of its own, with its memory."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun = time.perf_counter()
    subprocess.run([sys.executable, "-m", "robophm", *words], check=False, capture_output=True, cwd=path.parent)
    took = time.perf_counter() - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"robophm {' '.join(words[:1])}: {took:.2f} s, {used:.2f} s of a processor, {after.ru_maxrss / 1000:,.0f} MB")


def reports(path: Path, years: float) -> None:
    """Time the opening of the store, and of reports as they were."""
    begun = time.perf_counter()
    with SqliteStore(path) as store:
        store.ledger("arm")
        print(f"opened, ledger read: {1000 * (time.perf_counter() - begun):.1f} ms")
        draw, took, ages = random.Random(3), [], []
        for _ in range(200):
            at = BEGIN + round(draw.uniform(0, years * YEAR * MINUTE))
            begun = time.perf_counter()
            found = store.history("arm").report_at(at)
            took.append(1000 * (time.perf_counter() - begun))
            assert found
            ages.append((at - found["time"]) / HOUR)
        kept = sum(1 for _ in store.history("arm").reports())
    print(
        f"200 reports as they were: p99 {np.percentile(took, 99):.1f} ms, at most {max(ages):.1f} h old; {kept:,} kept"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the store where it is not yet there, and measure."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.years_of_history", description=__doc__)
    parser.add_argument("--years", type=float, default=10.0)
    parser.add_argument("--store", type=Path, default=Path("ten-years.db"), help="made where it is not there")
    said = parser.parse_args(arguments)
    path = said.store.resolve()
    if not path.exists():
        make(path, said.years)
    windows(path, said.years)
    reports(path, said.years)
    page = path.with_suffix(".html")
    command(path, "report", str(DESIGN), "--store", str(path), "--to", str(page), "--force")
    command(path, "report", str(DESIGN), "--to", str(page), "--force")
    command(path, "history", str(DESIGN), "--store", str(path), "--json")


if __name__ == "__main__":
    main()
