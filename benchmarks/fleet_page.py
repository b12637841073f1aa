"""The fleet's page and the worst of many robots: ``python -m benchmarks.fleet_page [--robots 100000] [--postgresql]``.

Each robot has sent eleven reports of as many days, one in fifty nothing. Tells how long each list takes at the store,
and the page until all of it is there, in milliseconds of the processor of all that take part: the mean of ten, after a
first time.
"""

from __future__ import annotations

import argparse
import http.client
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from benchmarks.fleet_load import of_database, store_address, used
from robophm.fleet.page.listing import DAY, Asked, groups, lines
from robophm.fleet.payload import Ahead, Payload, PresentState, Report
from robophm.fleet.questions import worst
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

TOGETHER = 500


def figures(chance: float) -> tuple[float, ...]:
    """Figures of a report that states this probability of failing within a week."""
    values = dict.fromkeys(COLUMNS, 0.1) | {"failure_within.168": chance, "state": 0.0, "bound": 0.0}
    return tuple(values[name] for name in COLUMNS)


def fill(store: FleetStore, robots: int) -> None:
    """Have many robots send what they have."""
    names = [f"courier-{at:06}" for at in range(robots)]
    for site, some in (("Kiel", names[::3]), ("Lyon", names[1::3]), (None, names[2::3])):
        store.add_tokens(some, site)
    chance, now = random.Random(1), time.time_ns()
    for first in range(0, robots, TOGETHER):
        payloads = []
        for name in names[first : first + TOGETHER]:
            within = 10 ** chance.uniform(-4, -0.5)
            past = [Report(at + 1, now - (10 - at) * DAY, 0, figures(within * (0.6 + 0.08 * at))) for at in range(11)]
            whole = {"robot": chance.choice(["courier 2", "courier 3"]), "design_hash": "d", "time": now}
            state = PresentState(1, "{}", whole, (Ahead(168.0, within, "Mobility/motor", 0.6),))
            if chance.random() > 0.02:
                payloads.append(Payload(name, "a" * 16, now, 0, tuple(past), state))
        store.commit(payloads)


def milliseconds(ask: Callable[[], object], processes: list[int], base: int | None) -> float:
    """The processor time of one question in some processes and a database: the mean of ten, after a first time."""

    def taken() -> float:
        return sum(used(one)[0] for one in processes) + of_database(base)[0]

    ask()
    before = taken()
    for _ in range(10):
        ask()
    return 100 * (taken() - before)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_page", description=__doc__)
    parser.add_argument("--robots", type=int, default=100_000)
    parser.add_argument("--postgresql", action="store_true")
    asked = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as folder,
        store_address(Path(folder), postgresql=asked.postgresql) as (place, base),
    ):
        with FleetStore(place, make=True) as store:
            fill(store, asked.robots)
            query = "SELECT robot FROM newest WHERE chance_1 IS NOT NULL ORDER BY chance_1 DESC LIMIT 20"
            for what, ask in {
                "numbers of the worst 20": lambda: store.rows(query),
                "worst 20, with how many are known": lambda: worst(store, 168.0, 20),
                "first 100 lines": lambda: lines(store, Asked(), 0, 100),
                "lines from the middle": lambda: lines(store, Asked(), asked.robots // 2, 100),
                "largest rises": lambda: lines(store, Asked(order="risen"), 0, 100),
                "search": lambda: lines(store, Asked(search="-0999"), 0, 100),
                "groups by design": lambda: groups(store, "design", 168.0, 0),
            }.items():
                print(f"{what}: {milliseconds(ask, [os.getpid()], base):.0f} ms", flush=True)
        words = [sys.executable, "-m", "robophm", "fleet", "serve", "--store", place, "--port", "0"]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as service:
            assert service.stdout
            port = int(re.findall(r":(\d+)/", service.stdout.readline())[0])

            def page(path: str) -> None:
                connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
                connection.request("GET", path)
                assert connection.getresponse().status == 200
                connection.close()

            middle = f"/?start={asked.robots // 2}"
            for path in ("/", middle, "/?order=risen", "/groups?by=design", "/robot?name=courier-000001"):
                took = milliseconds(lambda path=path: page(path), [service.pid], base)
                print(f"page {path}: {took:.0f} ms", flush=True)
            service.send_signal(signal.SIGINT)
    return 0


if __name__ == "__main__":
    sys.exit(main())
