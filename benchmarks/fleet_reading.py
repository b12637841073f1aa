"""How long a robot's year takes to be read: ``python -m benchmarks.fleet_reading [--robots 16]``.

A report a minute of each robot, made up, with digits that are noise as those of figures that follow sensors. Eleven
months are in Parquet, once by days and once by months, and the last one in the fleet's store. Tells how long
``history`` takes for all fourteen figures in 500 points, how much of it the files take, and how long the command takes
from its start to its end. ``--duckdb`` asks DuckDB, where it is installed, for the same of the months, and for one
figure by the hour. The least of five runs each.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as arrow

from robophm.core.signal import DAY, HOUR, SECOND
from robophm.fleet.compaction import join_months
from robophm.fleet.history_files import OVER, ReportsFile, name_of, schema
from robophm.fleet.kept_days import kept_reports
from robophm.fleet.payload import Payload, Report
from robophm.fleet.robot_history import history
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

BEGIN = np.datetime64("2025-01-01", "D").astype(int)
MOVED, DAYS = 334, 365
MINUTES = 24 * 60
NOISE = [at for at, name in enumerate(COLUMNS) if name not in ("state", "bound") and not name.endswith("nominal")]
EPOCH = "a" * 16


def day_of(robot: int, day: int) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Times [ns] and figures of a robot's reports of a day."""
    chance = np.random.default_rng([robot, day])
    figures = np.full((MINUTES, len(COLUMNS)), 0.0, np.float32)
    figures[:, NOISE] = 0.01 + 0.001 * chance.random((MINUTES, len(NOISE)))
    return (int(BEGIN) + day) * DAY + np.arange(MINUTES) * 60 * SECOND, figures


def table(robot: int, day: int) -> Any:
    times, figures = day_of(robot, day)
    received = times + np.random.default_rng(day).integers(0, 2 * SECOND, MINUTES)
    seq = day * MINUTES + 1 + np.arange(MINUTES)
    whole = (np.ones(MINUTES, np.int64), seq, times, received, np.zeros(MINUTES, np.int64))
    columns = [arrow.array([f"r{robot:03}"] * MINUTES), *map(arrow.array, whole), *map(arrow.array, figures.T)]
    return arrow.Table.from_arrays(
        [one.cast(kind.type) for one, kind in zip(columns, schema(), strict=True)], schema=schema()
    )


def make(store: FleetStore, folder: Path, robots: int) -> None:
    for day in range(MOVED):
        place = folder / name_of(int(BEGIN) + day) / "design=courier"
        place.mkdir(parents=True)
        with ReportsFile(place / "reports.parquet", 3) as file:
            for robot in range(robots):
                file.append(table(robot, day))
    store.add_token("r000")
    for day in range(MOVED, DAYS):
        times, figures = day_of(0, day)
        told = [Report(day * MINUTES + at, one, 0, tuple(row)) for at, (one, row)
                in enumerate(zip(times.tolist(), figures.tolist(), strict=True), 1)]  # fmt: skip
        store.commit([Payload("r000", EPOCH, times[0], 0, tuple(told), None)])
    with store.writing() as engine:
        engine.ask("UPDATE report SET received = time RETURNING robot", ())
        engine.ask(f"UPDATE epoch SET moved = {MOVED * MINUTES}, reports = {DAYS * MINUTES} RETURNING robot", ())


def least(work: Callable[[], Any]) -> tuple[float, float, Any]:
    """The least time on the clock and of the processor [s], and what is returned."""
    found = []
    for _ in range(5):
        clock, processor = time.perf_counter(), time.process_time()
        answer = work()
        found.append((time.perf_counter() - clock, time.process_time() - processor))
    clocks, processors = zip(*found, strict=True)
    return min(clocks), min(processors), answer


def tell(what: str, work: Callable[[], Any]) -> Any:
    clock, processor, answer = least(work)
    print(f"{what}: {clock * 1e3:.0f} ms, {processor * 1e3:.0f} ms of a processor", flush=True)
    return answer


def by_duckdb(folder: Path) -> None:
    import duckdb

    files = [str(path) for path in sorted(folder.rglob("*.parquet"))]
    base = duckdb.connect()
    every = ", ".join(f'min("{name}"), avg("{name}"), max("{name}"), count("{name}")' for name in COLUMNS)
    for what, asked, width in (("all figures in days", every, DAY), ("one figure by the hour", f'avg("{COLUMNS[-2]}")',
                                                                       HOUR)):  # fmt: skip
        query = (
            f"SELECT epoch_ns(time) // {width} AS span, {asked} FROM read_parquet($1) WHERE robot = $2 GROUP BY span"
        )
        tell(f"DuckDB, months, {what}", lambda query=query: base.execute(query, [files, "r000"]).fetchall())


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_reading", description=__doc__)
    parser.add_argument("--robots", type=int, default=16)
    parser.add_argument("--duckdb", action="store_true")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        place, folder = Path(made) / "fleet.db", Path(made) / "days"
        answers = []
        with FleetStore(place, make=True) as store:
            make(store, folder, asked.robots)
            for what in ("days", "months"):
                if what == "months":
                    join_months(folder, (int(BEGIN) + DAYS + 31) * DAY + OVER)
                tell(f"{what}, the files", lambda: kept_reports(folder, "r000", {1: MOVED * MINUTES}, ()))
                answers.append(tell(f"{what}, the answer", lambda: history(store, "r000", None, None, 500, folder)))
            tell("the month that is in the store", lambda: history(store, "r000", None, None, 500))
        if any(
            one.tobytes() != other.tobytes() for one, other in zip(*(one.series[1:] for one in answers), strict=True)
        ):
            raise RuntimeError("months answer otherwise than days")
        words = ["fleet", "history", "r000", "--store", place, "--parquet", folder]
        tell("the command", lambda: subprocess.run([sys.executable, "-m", "robophm", *map(str, words)], check=True,
                                                   stdout=subprocess.DEVNULL))  # fmt: skip
        if asked.duckdb:
            by_duckdb(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
