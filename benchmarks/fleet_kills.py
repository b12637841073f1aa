"""Seeded courses in which robots, network, service, database and broker of a fleet are killed at random.

``python -m benchmarks.fleet_kills [--courses 100] [--first 0] [--postgresql] [--mqtt]``: each course has
three robots with 150 reports and four rounds of kills (SIGKILL) of robots, service, database and broker, alone and
together, over a network that cuts requests and answers, or a Mosquitto that is killed.
Exits with 1 at the first course in which a report was lost or counted twice, or a fleet's ledger is not the robot's
own, letter by letter.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from contextlib import nullcontext
from pathlib import Path

from tests.fleet.killed import KilledBroker, course
from tests.fleet.postgresql_server import running


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_kills", description=__doc__)
    parser.add_argument("--courses", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    parser.add_argument("--postgresql", action="store_true", help="the store is in one, which is killed too")
    parser.add_argument("--mqtt", action="store_true", help="over a broker, which is killed too")
    asked = parser.parse_args()
    begun, reports, epochs = time.monotonic(), 0, 0
    for seed in range(asked.first, asked.first + asked.courses):
        with tempfile.TemporaryDirectory() as made, running() if asked.postgresql else nullcontext() as database:
            folder = Path(made)
            broker = KilledBroker(folder) if asked.mqtt else None
            try:
                found = course(folder, seed, robots=3, most=150, kills=4, database=database, broker=broker)
            except AssertionError as error:
                print(f"course {seed}: {error}")
                return 1
            finally:
                if broker:
                    broker.stop()
        reports, epochs = reports + found["reports"], epochs + found["epochs"]
        print(f"\r{seed + 1 - asked.first} of {asked.courses}", end="", file=sys.stderr, flush=True)
    print(f"\n{asked.courses} courses, {reports} reports in {epochs} epochs of {3 * asked.courses} robots: 0 lost, "
          f"0 twice, all ledgers equal; {time.monotonic() - begun:.0f} s")  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
