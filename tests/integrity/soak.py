"""``python -m tests.integrity.soak``: two days of a robot at 600 times their pace, served, looked at, and disturbed.

A service watches the robot over ROS 1, then over DDS, with a store, a journal and a browser on its live page. Whoever
publishes is killed now and then, of ROS 1 the master too. Memory, descriptors and threads of the service are measured
all the while, and how long it takes to answer. At the end its ledger must be that of its journal, once. Memory may grow
during the first day, of which it remembers what tasks are judged by.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from scipy.stats import linregress

from robophm.core.errors import SourceError
from robophm.core.signal import HOUR
from robophm.design.file import parse
from robophm.monitoring.live_tasks import LONGEST
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.ros1.xmlrpc import call

from ..transports.ros1.conftest import free_port
from .soak_senders import DDS, ROS1

PACE = 600
"""Simulated seconds in a second."""
BEGIN = 1_795_000_020
WARM = LONGEST / HOUR
"""Hours of the robot after which what grows at first has grown: what is remembered for tasks."""
KILLED = 0.002
"""Chance of each minute of the robot that whoever publishes is killed in it."""
BLOCKS = 20
"""Stretches of a run whose means show a slope."""
QUIET = 3.0
"""Seconds at the end without a kill."""

DESIGN = """\
schema_version: 1
name: R
max_gap: 10 min
acceleration: {model: q10, reference_temperature: 25 degC}
thresholds: {hazard_rate: 1 /h}
components:
  hot: {rate: 0.01 /h, signals: {temperature: {topic: /hot, field: temperature, unit: degC, max_age: 2 min}}}
  warm: {rate: 0.02 /h, signals: {temperature: {topic: /warm, field: temperature, unit: degC, max_age: 2 min}}}
"""

PEERS = Path(__file__).parents[1] / "transports" / "ros2_dds"
"""The folder where the types of what is sent over DDS are."""

NO_PROXY = {"trust_env": False, "timeout": 30}


class Robot:
    """Who publishes, and the master of ROS 1, each started again when it is gone."""

    def __init__(self, via: str, folder: Path) -> None:
        self.via, self.kills = via, Counter[str]()
        self._begun = time.monotonic()
        self._folder, self._simulated = folder, via == "ros2"
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        self.port = free_port()
        uri = f"http://127.0.0.1:{self.port}"
        ros1 = {"ROS_MASTER_URI": uri, "ROS_IP": "127.0.0.1", "ROS_HOME": str(folder), "HOME": str(folder)}
        ros2 = {"ROS_DOMAIN_ID": "97", "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "CYCLONEDDS_URI": _LOOPBACK}
        self.environment = ros1 if via == "ros1" else ros2
        self.uri = uri

    @property
    def hours(self) -> float:
        """Simulated hours so far."""
        return (time.monotonic() - self._begun) * PACE / 3600

    def look(self) -> None:
        """Start what does not run and can."""
        if self.via == "ros1":
            if not self._runs("master"):
                self._simulated = False
                self._start("master", "/usr/bin/roscore", "-p", str(self.port))
            if not self._simulated:
                with suppress(SourceError):
                    call(self.uri, "setParam", "/test", "/use_sim_time", True)
                    self._simulated = True
        if self._simulated and not self._runs("sender"):
            program, code = ("/usr/bin/python3", ROS1) if self.via == "ros1" else (sys.executable, DDS)
            self._start("sender", program, "-c", code, str(self._begun), str(PACE), str(BEGIN), str(PEERS))

    def kill(self, which: str) -> None:
        """End it with SIGKILL, where it runs."""
        if which == "master":
            with suppress(SourceError, ProcessLookupError):
                os.kill(call(self.uri, "getPid", "/test"), signal.SIGKILL)
                self.kills[which] += 1
        elif self._runs(which):
            self._running[which].kill()
            self._running[which].wait()
            self.kills[which] += 1

    def close(self) -> None:
        """End all of it."""
        for process in self._running.values():
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)
            with suppress(subprocess.TimeoutExpired):
                process.wait(10)
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)

    def _runs(self, which: str) -> bool:
        return which in self._running and self._running[which].poll() is None

    def _start(self, which: str, *command: str) -> None:
        own = {"PATH": "/usr/bin:/bin"} | self.environment
        self._running[which] = subprocess.Popen(
            command, env=own, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )


_LOOPBACK = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General></Domain>'
    "</CycloneDDS>"
)


@contextmanager
def served(robot: Robot, folder: Path) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """The service, and its address."""
    port = free_port()
    words = ["robot.yaml", "--port", str(port), "--store", "past.db", "--journal", "run.journal", "--start", robot.via]
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "serve", *words], cwd=folder, env=os.environ | robot.environment,
        stdout=subprocess.DEVNULL, stderr=(folder / "service.txt").open("w"),
    )  # fmt: skip
    try:
        yield process, f"http://127.0.0.1:{port}"
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()


@contextmanager
def browser(address: str) -> Iterator[bool]:
    """A browser on the live page; whether there is one here."""
    chromium = shutil.which("chromium")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        chromium = None
    if not chromium:
        yield False
        return
    with sync_playwright() as playwright:
        page = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]).new_page()
        page.goto(f"{address}/#/live", timeout=120_000)
        yield True


def measured(pid: int) -> tuple[float, int, int]:
    """Memory [MB], descriptors and threads of a process."""
    own = Path(f"/proc/{pid}")
    memory = int((own / "statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") / 1e6
    return memory, len(list((own / "fd").iterdir())), len(list((own / "task").iterdir()))


def soak(via: str, hours: float, seed: int) -> dict[str, Any]:
    """Let a robot run for so many hours of its own; return what was measured."""
    dice, seconds = random.Random(seed), hours * 3600 / PACE
    with tempfile.TemporaryDirectory(prefix="robophm.") as apart, ExitStack() as stack:
        folder = Path(apart)
        (folder / "robot.yaml").write_text(DESIGN)
        robot = Robot(via, folder)
        stack.callback(robot.close)
        while not robot._runs("sender"):
            robot.look()
            time.sleep(0.1)
        process, address = stack.enter_context(served(robot, folder))
        client = stack.enter_context(httpx.Client(base_url=address, **NO_PROXY))  # type: ignore[arg-type]
        _ready(client)
        page = stack.enter_context(browser(address))
        begun, rows, minutes = time.monotonic(), [], 0
        while (now := time.monotonic() - begun) < seconds:
            robot.look()
            while minutes < now * PACE / 60:
                minutes += 1
                for which in ("sender", "master")[: 2 if via == "ros1" else 1]:
                    if dice.random() < KILLED and now < seconds - QUIET:
                        robot.kill(which)
            asked = time.perf_counter()
            client.get("/api/monitoring").raise_for_status()
            rows.append((now, 1000 * (time.perf_counter() - asked), *measured(process.pid)))
            time.sleep(0.1)
        client.close()
        ended = time.monotonic()
        process.send_signal(signal.SIGTERM)
        process.wait(60)
        ended = time.monotonic() - ended
        assert process.returncode == 0, (folder / "service.txt").read_text()
        return {
            "via": via, "hours": hours, "kills": dict(robot.kills), "page": page, "ended within [s]": ended,
            **figures(rows, hours), "ledger is that of the journal": same(folder),
        }  # fmt: skip


def _ready(client: httpx.Client) -> None:
    until = time.monotonic() + 120
    while True:
        with suppress(httpx.TransportError):
            if client.get("/readyz").status_code == 200:
                return
        assert time.monotonic() < until, "the service does not begin"
        time.sleep(0.2)


def figures(rows: Sequence[Sequence[float]], hours: float) -> dict[str, Any]:
    """The course of what was measured: how much it grew, how sure that is, and the 99 % quantile of the answers."""
    found: dict[str, Any] = {}
    table = np.array(rows)
    later = table[table[:, 0] * PACE / 3600 > WARM]
    blocks = [block.mean(axis=0) for block in np.array_split(later, BLOCKS)]
    at = [block[0] * PACE / 3600 for block in blocks]
    for column, name in ((2, "memory [MB]"), (3, "descriptors"), (4, "threads")):
        values = [block[column] for block in blocks]
        line = linregress(at, values)
        found[name] = {
            "mean": float(np.mean(values)), "most": float(later[:, column].max()), "slope an hour": float(line.slope),
            "standard error": float(line.stderr), "grows": bool(line.slope > 3 * line.stderr > 0),
        }  # fmt: skip
    share = max(1, round(len(table) / max(hours, 2)))
    first, last = (float(np.percentile(some[:, 1], 99)) for some in (table[:share], table[-share:]))
    return found | {"answers, p99 of the first hour [ms]": first, "of the last": last}


def same(folder: Path) -> bool:
    """Whether the ledger is what the journal gives when it is replayed."""
    again = MemoryStore()
    replay(parse(DESIGN), folder / "run.journal", store=again, period=1.0)
    with SqliteStore(folder / "past.db") as store:
        return store.ledger("R") == again.ledger("R")


def main() -> int:
    """Soak, and print what was measured as JSON; 1 where something grows or counts wrongly."""
    parser = argparse.ArgumentParser(prog="python -m tests.integrity.soak", description=__doc__)
    parser.add_argument("--hours", type=float, default=48.0, help=f"of the robot, each {3600 / PACE:.0f} s here")
    parser.add_argument("--via", choices=["ros1", "ros2"], action="append")
    parser.add_argument("--seed", type=int, default=1)
    said = parser.parse_args()
    if said.hours <= WARM + 1:
        parser.error(f"{said.hours:g} hours: expected more than {WARM + 1:g}, for memory grows until then")
    wrong = False
    for via in said.via or ("ros1", "ros2"):
        found = soak(via, said.hours, said.seed)
        print(json.dumps(found, indent=1), flush=True)
        grows = [name for name in ("memory [MB]", "descriptors", "threads") if found[name]["grows"]]
        wrong |= bool(grows) or not found["ledger is that of the journal"]
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())
