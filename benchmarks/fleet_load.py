"""Load of a fleet's service: ``python -m benchmarks.fleet_load [--robots 300 …] [--seconds 60] [--postgresql]``.

Each robot sends a report a minute over a connection of its own, evenly spread, whole report and ledger with every tenth
(``--whole-every``); the service is a process of its own with its store on this disk. The figures are those of a few
robots that really fail, as ``robophm fleet simulate`` makes them, each told under many names. Tells how many reports
were taken in a second, how late each was on the disk (lag), what processor and memory the service took, how long the
worst twenty take to be asked for, and how much the store grows. Exits with 1 where a report is missing, or the lag's
99th percentile is above a minute.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import itertools
import json
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tests.fleet.postgresql_server import running

from robophm.fleet.payload import packed
from robophm.fleet.questions import worst
from robophm.fleet.simulated import SimulatedRobot, simulated_robots
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import Batch, Present, Waiting, report_values

DESIGN = Path(__file__).parents[1] / "examples" / "fleet" / "robot.yaml"
EPOCH = "a" * 16
FULL = 400
"""Reports of which a store's size says something: fewer are in pages that are hardly filled."""
AT_ONCE = 128
"""Robots that send at the same time, at most: those beyond it are late."""


class Load:
    """The payloads of many robots, made of the reports of a few."""

    def __init__(self, few: list[SimulatedRobot], tokens: dict[str, str], whole_every: int) -> None:
        self._few, self._names, self._every = few, [*tokens], whole_every
        self._heads = [f"POST /robots/{name}/reports HTTP/1.1\r\nHost: fleet\r\nConnection: close\r\nAuthorization: "
                       f"Bearer {token}\r\nContent-Length: " for name, token in tokens.items()]  # fmt: skip
        self._rows = [[report_values(one) for one in robot.reports] for robot in few]
        self._ledgers = [json.dumps(robot.ledger) for robot in few]

    def request(self, number: int) -> bytes:
        """The request that comes as this one of all: robots take turns, one report each in a round."""
        turn, at = divmod(number, len(self._names))
        robot = at % len(self._few)
        reports, now = self._few[robot].reports, time.time_ns()
        which = (turn + at // len(self._few)) % len(reports)
        row = Waiting(turn + 1, EPOCH, turn + 1, now, 0, self._rows[robot][which])
        whole = number % self._every == 0
        report = {**reports[which], "time": now} if whole else None
        state = Present(EPOCH, turn + 1, self._ledgers[robot], report) if whole else None
        body = packed(self._names[at], now, Batch((row,), 0, state))
        return f"{self._heads[at]}{len(body)}\r\n\r\n".encode() + body


async def sent(port: int, load: Load, rate: float, count: int) -> list[float]:
    """Send so many requests at so many a second; return how late each was answered after it was due [s]."""
    gate, begun, lags = asyncio.Semaphore(AT_ONCE), time.monotonic(), []

    async def one(number: int) -> None:
        try:
            for _ in range(20):  # a service that is busy lets go of connections; a robot tries again
                with contextlib.suppress(OSError):
                    reader, writer = await asyncio.open_connection("127.0.0.1", port)
                    writer.write(load.request(number))
                    answer = await reader.read()
                    writer.close()
                    if answer.startswith(b"HTTP/1.1 200"):
                        break
                await asyncio.sleep(0.2)
            lags.append(time.monotonic() - begun - number / rate)
        finally:
            gate.release()

    async with asyncio.TaskGroup() as group:
        for number in range(count):
            await asyncio.sleep(max(0.0, begun + number / rate - time.monotonic()))
            await gate.acquire()
            group.create_task(one(number))
    return lags


@contextlib.contextmanager
def store_address(folder: Path, *, postgresql: bool) -> Iterator[tuple[str, int | None]]:
    """The address of a store that is not there yet, in either engine, and the process of a database."""
    if not postgresql:
        yield str(folder / "fleet.db"), None
        return
    with running("shared_buffers=512MB", "max_wal_size=4GB") as server:
        yield server.address, server.process


def used(process: int) -> tuple[float, float]:
    """Seconds of the processor that a process has taken, and its peak of memory [MB]."""
    ticks = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    (memory,) = re.findall(r"VmHWM:\s+(\d+)", Path(f"/proc/{process}/status").read_text())
    return (int(ticks[11]) + int(ticks[12])) / 100, int(memory) / 1024


def of_database(process: int | None) -> tuple[float, float]:
    """Seconds of the processor and proportional memory [MB] of a database with all that it has begun; zero of none."""
    all_of_it = [] if process is None else [process, *map(int, Path(f"/proc/{process}/task/{process}/children")
                                                          .read_text().split())]  # fmt: skip
    memory = sum(int(re.findall(r"^Pss:\s+(\d+)", Path(f"/proc/{one}/smaps_rollup").read_text(), re.M)[0])
                 for one in all_of_it)  # fmt: skip
    return sum(used(one)[0] for one in all_of_it), memory / 1024


class Measured(NamedTuple):
    """What was seen of one load."""

    robots: int
    rate: float
    """Reports that came, a second."""
    taken: float
    """Reports that were taken, a second."""
    lags: list[float]
    """How late each was answered [s], ascending."""
    service: tuple[float, float]
    """Processor a report [ms] and peak of memory [MB] of the service."""
    database: tuple[float, float] | None
    worst: float
    """Time that the worst twenty take to be asked for [s]."""
    missing: int
    bytes_each: float
    """Size of a report in the store with its index [bytes]."""


def measured(few: list[SimulatedRobot], robots: int, asked: argparse.Namespace) -> Measured:
    with (
        tempfile.TemporaryDirectory() as folder,
        store_address(Path(folder), postgresql=asked.postgresql) as (address, base),
    ):
        names = [f"r{at}" for at in range(robots)]
        with FleetStore(address, make=True) as store:
            tokens = dict(zip(names, store.add_tokens(names), strict=True))
        words = [sys.executable, "-m", "robophm", "fleet", "serve", "--store", address, "--port", "0"]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as service:
            assert service.stdout
            port = int(re.findall(r":(\d+)/", service.stdout.readline())[0])
            rate, before, idle = robots / 60, used(service.pid)[0], of_database(base)[0]
            count = round(rate * asked.seconds)
            begun = time.monotonic()
            lags = sorted(asyncio.run(sent(port, Load(few, tokens, asked.whole_every), rate, count)))
            took = time.monotonic() - begun
            (seconds, memory), (busy, held) = used(service.pid), of_database(base)
            service.send_signal(signal.SIGINT)
        with FleetStore(address) as store:
            ((there,),) = store.rows("SELECT count(*) FROM report")
            size = "SELECT pg_total_relation_size('robophm_fleet.report')" if base else (
                "SELECT sum(pgsize) FROM dbstat WHERE name = 'report'")  # fmt: skip
            ((size_of_all,),) = store.rows(size)
            times = []
            for _ in range(20):
                begun = time.perf_counter()
                worst(store, 168.0, 20)
                times.append(time.perf_counter() - begun)
    return Measured(robots, rate, count / took, lags, (1000 * (seconds - before) / count, memory),
                    (1000 * (busy - idle) / count, held) if base else None, statistics.median(times), count - there,
                    size_of_all / there)  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_load", description=__doc__)
    parser.add_argument("--robots", type=int, nargs="+", default=[300], help="several are measured one after another")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--whole-every", type=int, default=10)
    parser.add_argument("--postgresql", action="store_true")
    asked = parser.parse_args()
    few = [*itertools.islice(simulated_robots(DESIGN, 8, 10, 1, 3600.0 * 4, time.time_ns()), 8)]
    found = []
    for robots in asked.robots:
        found.append(one := measured(few, robots, asked))
        print(f"{robots} robots: {one.taken:.1f} reports a second of {one.rate:.1f} that came; missing: {one.missing}")
        print(f"lag: median {statistics.median(one.lags):.2f} s, 99 % {p99(one):.2f} s, longest {one.lags[-1]:.2f} s")
        print(f"service: {one.service[0]:.2f} ms of a processor a report, {one.service[1]:.0f} MB at its peak")
        if one.database:
            print(f"database: {one.database[0]:.2f} ms of a processor a report, {one.database[1]:.0f} MB")
        if robots * asked.seconds >= 60 * FULL:
            print(f"store: {one.bytes_each:.0f} bytes a report, {one.bytes_each * robots * 1440 / 1e6:.0f} MB a day")
        print(f"worst 20: {1000 * one.worst:.1f} ms\n", flush=True)
    return int(any(one.missing or p99(one) > 60 for one in found))


def p99(one: Measured) -> float:
    return one.lags[int(len(one.lags) * 0.99)]


if __name__ == "__main__":
    sys.exit(main())
