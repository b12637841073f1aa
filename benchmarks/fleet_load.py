"""Load of a fleet's service: ``python -m benchmarks.fleet_load [--robots 300]``.

Each robot sends what an hour without network has left, then the report of a minute, each over a connection of its own
and with a ledger, 32 at once; the service is a process of its own with its store on this disk. Tells how long all of
them take, the slowest answer, and the service's peak of memory. Exits with 1 where a report is missing.
"""

from __future__ import annotations

import argparse
import http.client
import json
import re
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.fleet.made_reports import BEGIN, MINUTE, report

from robophm.fleet.payload import packed
from robophm.fleet.questions import status
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import Batch, Present, Waiting, report_values

EPOCH = "a" * 16
LEDGER = json.dumps({"sums": [0.123456789 + at for at in range(1000)]})
"""A ledger as large as that of a robot of fifty parts: 20 kB."""


def body(robot: str, first: int, end: int) -> bytes:
    """The payload of the reports of some minutes."""
    rows = tuple(Waiting(at, EPOCH, at, BEGIN + at * MINUTE, 0, report_values(report(at))) for at in range(first, end))
    return packed(robot, time.time_ns(), Batch(rows, 0, Present(EPOCH, end, LEDGER, report(end - 1))))


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_load", description=__doc__)
    parser.add_argument("--robots", type=int, default=300)
    count = parser.parse_args().robots
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fleet.db"
        with FleetStore(path, make=True) as store:
            tokens = {f"r{at}": store.add_token(f"r{at}") for at in range(count)}
        words = [sys.executable, "-m", "robophm", "fleet", "serve", "--store", str(path), "--port", "0"]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as service:
            assert service.stdout
            port = int(re.findall(r":(\d+)/", service.stdout.readline())[0])

            def post(robot: str, said: bytes) -> float:
                begun = time.monotonic()
                connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
                headers = {"Authorization": f"Bearer {tokens[robot]}"}
                connection.request("POST", f"/robots/{robot}/reports", said, headers)
                assert connection.getresponse().status == 200
                connection.close()
                return time.monotonic() - begun

            for what, first, end in (("an hour", 1, 61), ("a minute", 61, 62)):
                bodies = [body(robot, first, end) for robot in tokens]
                with ThreadPoolExecutor(32) as together:
                    begun = time.monotonic()
                    slowest = max(together.map(post, tokens, bodies))
                    took = time.monotonic() - begun
                print(f"{what} of {count} robots: {took:.1f} s, slowest answer {slowest:.2f} s")
            memory = re.findall(r"VmHWM:\s+(\d+)", Path(f"/proc/{service.pid}/status").read_text())
            print(f"memory of the service at its peak: {int(memory[0]) / 1024:.0f} MB")
            service.send_signal(signal.SIGINT)
        with FleetStore(path) as store:
            found = status(store)
    return int(any((one.reports, one.missing) != (61, 0) for one in found))


if __name__ == "__main__":
    sys.exit(main())
