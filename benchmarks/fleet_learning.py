"""Time to learn of many robots: ``python -m benchmarks.fleet_learning [--robots 1000]``; processor time, on SQLite.

Robots of one design of five parts, on three sites, of which one part fails now and then.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.fleet.cohorts import compare
from robophm.fleet.experience import experience
from robophm.fleet.payload import Payload, PresentState
from robophm.fleet.store import FleetStore
from robophm.health.ledger import Ledger
from robophm.health.service import ServiceNote, take_note
from robophm.learning.rates.rate_update import learn

DESIGN = """
schema_version: 1
name: courier
components:
  motor: {life: {distribution: weibull, scale: 100 h, shape: 2}}
  arm: {rate: 0.001 /h, quantity: 2}
  eye: {rate: 0.01 /h}
  ear: {rate: 0.01 /h}
  box: {rate: 0.001 /h}
"""
AT_ONCE = 100


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_learning", description=__doc__)
    parser.add_argument("--robots", type=int, default=1000)
    number, robot, chance = parser.parse_args().robots, parse(DESIGN), random.Random(1)
    with tempfile.TemporaryDirectory() as folder, FleetStore(Path(folder) / "fleet.db", make=True) as store:
        for first in range(0, number, AT_ONCE):
            names = [f"r{at}" for at in range(first, min(first + AT_ONCE, number))]
            store.add_tokens(names, "ABC"[first // AT_ONCE % 3])
            payloads = []
            for name in names:
                ledger = Ledger.new(robot)
                ledger.started = ledger.integrated_to = 1_750_000_000 * SECOND
                for total in (ledger.age, ledger.effective):
                    total.add(np.full(len(ledger.modes), 10.0))
                if chance.random() < 0.1:
                    take_note(robot, ledger, ServiceNote("eye", failed=True))
                report = {"robot": robot.name, "design_hash": robot.design_hash, "time": ledger.started}
                state = PresentState(1, json.dumps(ledger.to_json()), report, ())
                payloads.append(Payload(name, "a" * 16, time.time_ns(), 0, (), state))
            store.commit(payloads)
        begun = time.process_time()
        ((found,), _) = experience(store, [robot])
        read = time.process_time()
        rates = learn(robot, found.seen, each_robot=False)
        learned = time.process_time()
        compared = compare([found]).compared
        done = time.process_time()
    print(f"{len(found.robots)} robots read in {read - begun:.2f} s; {len(rates)} rates learned in "
          f"{learned - read:.2f} s; {len(compared)} cohorts' parts compared in {done - learned:.2f} s")  # fmt: skip
    return 0


if __name__ == "__main__":
    sys.exit(main())
