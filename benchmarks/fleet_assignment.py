"""Time to assign 1,000 tasks to 1,000 robots, exactly: ``python -m benchmarks.fleet_assignment [--size 1000]``.

Processor time of three kinds of tables of probabilities of completion; exits with 1 where one takes more than a second.
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

from robophm.fleet.assignment import assign

MOST = 1.0
"""Seconds that one of 1,000 × 1,000 may take."""


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_assignment", description=__doc__)
    parser.add_argument("--size", type=int, default=1000)
    size, chance, worst = parser.parse_args().size, np.random.default_rng(1), 0.0
    tables = {
        "any probabilities": chance.uniform(size=(size, size)),
        "failures of 1 in a million to 1 in 10": 1 - 10.0 ** chance.uniform(-6, -1, size=(size, size)),
        "weak robots times hard tasks": 1
        - np.outer(10.0 ** chance.uniform(-5, -3, size), 10.0 ** chance.uniform(0, 2, size)),
    }
    for name, table in tables.items():
        begun = time.process_time()
        found = assign(np.log(table))
        took = time.process_time() - begun
        worst = max(worst, took)
        print(f"{name}: {len(found.pairs)} pairs, {took:.3f} s")
    return int(worst > MOST and size <= 1000)


if __name__ == "__main__":
    sys.exit(main())
