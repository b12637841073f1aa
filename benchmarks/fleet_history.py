"""Size of a fleet's history as Parquet: ``python -m benchmarks.fleet_history [--robots 2] [--hours 24]``.

Robots of the paper that work all the time, one report a minute by the engine from what their sensors read, each
received up to two seconds later. The sizes are scaled to the 525,600 minutes of a year by the number of reports: of the
files of days, of those of the month that they are joined to, and in the latter of each column. The robots are new:
their probability of having failed changes most in the first days. ``--keep reports.pickle`` keeps what the engine
computed, or takes it from there.
"""

from __future__ import annotations

import argparse
import itertools
import pickle
import random
import sqlite3
import sys
import tempfile
import time
from contextlib import closing
from pathlib import Path

import robophm
from robophm.core.signal import HOUR, SECOND
from robophm.fleet.compaction import join_months
from robophm.fleet.daily_history import DAY, write_days
from robophm.fleet.history_files import OVER
from robophm.fleet.payload import MOST_REPORTS, packed, unpacked
from robophm.fleet.store import FleetStore
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.report_history import ReportHistory
from robophm.monitoring.seen_wear import seen_wear
from robophm.stores.outbox import HORIZONS, Batch, Present, Waiting, report_values
from robophm.transports.synthetic import SyntheticOta

YEAR = 365 * 24 * 60


def reported(hours: int, seed: int) -> list[Waiting]:
    """The reports of one robot as it would send them."""
    robot = robophm.load("examples/ota/robot.yaml")
    history = ReportHistory(robot, 60 * SECOND, None, lambda ledger: seen_wear(robot, ledger), horizons=HORIZONS)
    monitor = Monitor(robot, on_tick=history.follow)
    for sample in SyntheticOta(seed=seed, duration=hours * HOUR, working_hours=(0, 24)).samples(list(robot.signals)):
        monitor.observe(sample)
    return [Waiting(at, "a" * 16, at, one["time"], 0, report_values(one)) for at, one in enumerate(history.reports, 1)]


def by_column(folder: Path) -> dict[str, int]:
    """The bytes of each column in files, and of what is around them."""
    from pyarrow import parquet

    found: dict[str, int] = {}
    for path in folder.rglob("*.parquet"):
        meta = parquet.ParquetFile(path).metadata
        around = path.stat().st_size
        for group, at in itertools.product(range(meta.num_row_groups), range(meta.num_columns)):
            column = meta.row_group(group).column(at)
            found[column.path_in_schema] = found.get(column.path_in_schema, 0) + column.total_compressed_size
            around -= column.total_compressed_size
        found["footers"] = found.get("footers", 0) + around
    return found


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_history", description=__doc__)
    parser.add_argument("--robots", type=int, default=2)
    parser.add_argument("--hours", type=int, default=24)
    parser.add_argument("--keep", type=Path, help="file of the reports, made where there is none")
    asked = parser.parse_args()
    if asked.keep and asked.keep.exists():
        told = pickle.loads(asked.keep.read_bytes())
    else:
        told = [reported(asked.hours, seed) for seed in range(asked.robots)]
        if asked.keep:
            asked.keep.write_bytes(pickle.dumps(told))
    with tempfile.TemporaryDirectory() as made:
        path, folder, rows, chance = Path(made) / "fleet.db", Path(made) / "days", 0, random.Random(1)
        with FleetStore(path, make=True) as store:
            for name, some in ((f"r{at}", some) for at, some in enumerate(told)):
                store.add_token(name)
                state = Present("a" * 16, 1, "{}", {"robot": "OTA", "design_hash": "d"})
                for at in range(0, len(some), MOST_REPORTS):
                    batch = Batch(tuple(some[at : at + MOST_REPORTS]), 0, state)
                    store.commit([unpacked(packed(name, some[0].time, batch))])
                rows += len(some)
            with closing(sqlite3.connect(path)) as base, base:
                base.create_function("late", 0, lambda: chance.randrange(2 * SECOND))
                base.execute("UPDATE report SET received = time + late()")
                (last,) = base.execute("SELECT max(received) FROM report").fetchone()
            begun = time.process_time()
            found = write_days(store, folder, last + DAY + OVER)
            took = time.process_time() - begun
        begun = time.process_time()
        joined = join_months(folder, last + 32 * DAY + OVER)
        joining = time.process_time() - begun
        columns = by_column(folder)
        if found.rows != rows:
            raise RuntimeError(f"{found.rows} rows; expected {rows}")
        scale = YEAR / rows / 1e6
        print(f"{rows} reports of {len(told)} robots in {len(found.days)} days: Parquet {found.size * scale:.2f} MB "
              f"for a robot's year of minutes, {joined.after * scale:.2f} MB as a month, SQLite "
              f"{path.stat().st_size * scale:.1f} MB; written in {took / rows * 1e6:.0f} us of a processor a report, "
              f"joined and compared in {joining / rows * 1e6:.0f} us")  # fmt: skip
        for column, size in columns.items():
            print(f"{column:28} {size * scale:6.2f} MB, {size / rows:5.2f} bytes a report")
    return 0


if __name__ == "__main__":
    sys.exit(main())
