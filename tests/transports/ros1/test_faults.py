"""Hours of simulated time at sixty times its pace, in which master, publisher and watcher are killed at random.

A rospy publisher logs what it sends. What the watcher's journal lacks of that must lie where the journal says that
there is a gap; and the ledger must be what plain loops over the log make of the rest.
"""

from __future__ import annotations

import json
import math
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import HOUR, SECOND
from robophm.design.file import parse
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.journal_lines import SUM
from robophm.transports.ros1 import Node, Publisher
from robophm.transports.ros1.xmlrpc import call

from ..listener import within
from .conftest import PRELUDE, System

PACE = 60
"""Simulated seconds in a second."""
BEGIN = 1_700_000_000 * SECOND
PERIOD, MAX_AGE, MAX_GAP = 60 * SECOND, 60 * SECOND, 180 * SECOND
TOPICS = ("/warm", "/hot")
QUIET = 600
"""Simulated seconds at the end without a fault."""

DESIGN = f"""
schema_version: 1
name: R
max_gap: {MAX_GAP // SECOND} s
acceleration: {{model: q10, reference_temperature: 25 degC}}
components:
""" + "".join(
    f"  {topic[1:]}: {{rate: 0.01 /h, signals: {{temperature: {{topic: {topic}, field: temperature, unit: degC, "
    f"max_age: {MAX_AGE // SECOND} s, range: [-40, 125]}}}}}}\n"
    for topic in TOPICS
)

PUBLISHER = """
import os, rosgraph, time
topics, logs = sys.argv[1].split(","), {}
sent = dict.fromkeys(topics, 0)
for topic in topics:
    logs[topic] = open(sys.argv[2] + topic.replace("/", "-"), "a+")
    logs[topic].seek(0)
    sent[topic] = sum(1 for line in logs[topic])
rospy.init_node("sensors", disable_signals=True)
outs = {topic: rospy.Publisher(topic, Temperature, queue_size=None) for topic in topics}
master, looked = rosgraph.Master("/sensors"), time.monotonic()
latest = rospy.Time(0)
while True:
    time.sleep(0.01)
    if time.monotonic() - looked > 0.5:  # as whoever starts a robot does for nodes that a new master does not know
        looked = time.monotonic()
        try:
            known = {topic: nodes for topic, nodes in master.getSystemState()[0]}
            for topic in topics:
                if "/sensors" not in known.get(topic, ()):
                    master.registerPublisher(topic, "sensor_msgs/Temperature", rospy.get_node_uri())
        except Exception:
            pass  # no master just now: the next one is asked in half a second
    now = rospy.Time.now()
    if now.secs == 0 or (now - latest).to_sec() < 6:
        continue
    latest = now
    for topic in topics:
        value = 20 + sent[topic] * 0.0005 + 5 * (topic == "/hot")
        sent[topic] += 1
        logs[topic].write("%d %r\\n" % (now.to_nsec(), value)); logs[topic].flush()
        outs[topic].publish(Temperature(header=Header(stamp=now), temperature=value))
"""


class Supervised:
    """A master, a clock, a publisher and a watcher; each is started again when it is gone."""

    def __init__(self, system: System, folder: Path) -> None:
        self.system, self.folder = system, folder
        self.kills: Counter[str] = Counter()
        self.refused = 0
        """Watchers that found no master."""
        self._master: subprocess.Popen[str] | None = None
        self._publisher: subprocess.Popen[str] | None = None
        self.watcher: subprocess.Popen[str] | None = None
        self._simulated = False
        self._begun = time.monotonic()
        self._over = threading.Event()
        self._clock: threading.Thread | None = None
        (folder / "robot.yaml").write_text(DESIGN)

    def now(self) -> float:
        """Simulated seconds."""
        return (time.monotonic() - self._begun) * PACE

    def look(self) -> None:
        """Start what does not run and can."""
        if self._master is None or self._master.poll() is not None:
            if self._master is not None:
                self.system.stop(self._master)
            self._simulated = False
            self._master = self.system.start("/usr/bin/roscore", "-p", str(self.system.port))
            return
        if not self._simulated:
            with suppress(SourceError):
                call(self.system.uri, "setParam", "/test", "/use_sim_time", True)
                self._simulated = True
            return
        if self._clock is None:
            self._clock = threading.Thread(target=self._tick)
            self._clock.start()
        if self._publisher is None or self._publisher.poll() is not None:
            code = PRELUDE + PUBLISHER
            log = str(self.folder / "log")
            self._publisher = self.system.start("/usr/bin/python3", "-c", code, ",".join(TOPICS), log)
        if self.watcher is None or self.watcher.poll() is not None:
            self._buried()
            words = ["robot.yaml", "--via", "ros1", "--store", "past.db", "--journal", "run.journal", "--period", "60"]
            with (self.folder / "watcher.txt").open("w") as said:
                self.watcher = subprocess.Popen(
                    [sys.executable, "-m", "robophm", "watch", *words, "--json", "--every", "1000"],
                    cwd=self.folder, env=os.environ | self.system.environment | {"PATH": os.environ["PATH"]},
                    text=True, stdout=subprocess.DEVNULL, stderr=said,
                )  # fmt: skip

    def _buried(self) -> None:
        if self.watcher is not None and self.watcher.returncode != -signal.SIGKILL:
            self.refused += 1
            said = (self.folder / "watcher.txt").read_text()
            assert "no ROS master" in said, said

    def kill(self, which: str) -> None:
        """With SIGKILL, where it runs."""
        if which == "roscore":
            with suppress(SourceError, ProcessLookupError):
                os.kill(call(self.system.uri, "getPid", "/test"), signal.SIGKILL)
                self._simulated = False
                self.kills[which] += 1
            return
        process = self._publisher if which == "publisher" else self.watcher
        if process is not None and process.poll() is None:
            process.kill()
            process.wait()
            self.kills[which] += 1

    def end(self) -> None:
        """End the publisher, let the watcher hear all, and tell it to end."""
        assert self._publisher is not None
        assert self.watcher is not None
        self._publisher.kill()
        self._publisher.wait()
        journal = self.folder / "run.journal"
        within(10, lambda: "connection lost on /hot" in journal.read_text().rpartition("/hot.temperature")[2])
        self.watcher.send_signal(signal.SIGINT)
        self.watcher.wait(30)

    def close(self) -> None:
        self._over.set()
        if self._clock:
            self._clock.join()
        for process in (self._publisher, self.watcher):
            if process is not None and process.poll() is None:
                process.kill()
                process.wait()
        if self._master is not None:
            self.system.stop(self._master, signal.SIGTERM)

    def _tick(self) -> None:
        with Node("/simulator", self.system.uri) as node, Publisher(node, "/clock", "rosgraph_msgs/Clock") as clock:
            while not self._over.wait(0.05):
                seconds, nanoseconds = divmod(BEGIN + round(self.now() * SECOND), SECOND)
                stamp = clock.types["builtin_interfaces/msg/Time"](seconds, nanoseconds)
                clock.publish(clock.types["rosgraph_msgs/msg/Clock"](clock=stamp))


@pytest.mark.full
@pytest.mark.parametrize(("hours", "chance"), [(0.75, 0.1), pytest.param(24, 0.01, id="day")])
def test_what_is_lost_through_faults_is_said_and_the_rest_is_lived(
    roscore: str, tmp_path: Path, hours: float, chance: float
) -> None:
    """``chance`` of each fault in each simulated minute."""
    dice, minutes = random.Random(7), 0
    system = System(tmp_path)
    run = Supervised(system, tmp_path)
    try:
        while run.now() < hours * 3600:
            run.look()
            while minutes < run.now() / 60:
                minutes += 1
                for which in ("roscore", "publisher", "watcher"):
                    if dice.random() < chance and run.now() < hours * 3600 - QUIET:
                        run.kill(which)
            time.sleep(0.02)
        run.end()
        assert run.watcher is not None
        warned = (tmp_path / "watcher.txt").read_text()
        assert run.watcher.returncode == 0, warned
    finally:
        run.close()
        system.close()
    assert all(run.kills[which] > 0 for which in ("roscore", "publisher", "watcher"))
    journal = [line[:-SUM] for line in (tmp_path / "run.journal").read_text().splitlines()]
    logs = {topic: logged(tmp_path / f"log{topic.replace('/', '-')}") for topic in TOPICS}
    heard, missing = heard_of(journal, logs)
    sent = sum(map(len, logs.values()))
    marks = Counter(line for line in journal if line.startswith("# gap"))
    print(f"\n{hours} h: kills {dict(run.kills)}, {sent} sent, {missing} in gaps, {dict(marks)}")
    assert all(marks[f"# gap connection lost on {topic}"] <= run.kills["publisher"] + 1 for topic in TOPICS)
    assert marks["# gap not listening"] <= run.kills["watcher"] + run.refused
    assert missing < sent / 2

    with SqliteStore(tmp_path / "past.db") as store:
        ledger = store.ledger("R")
    replayed = MemoryStore()
    replay(parse(DESIGN), tmp_path / "run.journal", store=replayed, period=PERIOD / SECOND)
    assert ledger == replayed.ledger("R")
    assert ledger is not None
    ledger = json.loads(json.dumps(ledger))
    lived(ledger, heard)


def logged(path: Path) -> list[tuple[int, float]]:
    """Stamp and value of all that a publisher has sent on a topic."""
    words = (line.split() for line in path.read_text().splitlines())
    return [(int(stamp), float(value)) for stamp, value in words]


def heard_of(journal: list[str], logs: dict[str, list[tuple[int, float]]]) -> tuple[list[tuple[int, str, float]], int]:
    """What of the logs has arrived, between the clock's samples, as logged; and how much has not.

    Fails where something is missing and no gap is said.
    """
    places = {topic: {value: i for i, (_, value) in enumerate(log)} for topic, log in logs.items()}
    latest = dict.fromkeys(logs, -1)
    gap = dict.fromkeys(logs, True)
    heard, missing = [], 0
    for line in journal:
        if line.startswith("# gap"):
            for topic in logs:
                gap[topic] |= line.endswith((f" on {topic}", "not listening"))
        if line.startswith("#"):
            continue
        words = line.split()
        at, topic = int(words[0]), words[2].removesuffix(".temperature")
        if topic == "clock":
            heard.append((at, topic, math.nan))
            continue
        i = places[topic][float(words[1])]
        assert i > latest[topic]
        assert i == latest[topic] + 1 or gap[topic], f"{line}: nothing is said of what is missing before"
        stamp, value = logs[topic][i]
        # more than 10 s before the time at which it came, or 1 s after it, a stamp is not believed
        assert at == stamp or not -10 * SECOND <= stamp - at <= SECOND
        heard.append((at, topic, value))
        missing += i - latest[topic] - 1
        latest[topic], gap[topic] = i, False
    for topic, log in logs.items():
        assert latest[topic] == len(log) - 1 or gap[topic]
        missing += len(log) - 1 - latest[topic]
    return heard, missing


def lived(ledger: dict[str, Any], heard: list[tuple[int, str, float]]) -> None:
    """Compare a ledger with plain loops over what was heard: one that has come too late for its period is counted."""
    newest = started = min(at for at, _, _ in heard[:1])
    until: int | None = None
    taken: dict[str, dict[int, float]] = {topic: {} for topic in TOPICS}
    late: Counter[str] = Counter()
    for at, topic, value in heard:
        if until is not None and at <= until:
            late[f"late: {topic}.temperature"] += topic != "clock"
            continue
        if topic != "clock":
            taken[topic][at] = max(value, taken[topic].get(at, -math.inf))
        if until is None:
            started = min(started, at)
        newest = max(newest, at)
        over = (newest - SECOND) // PERIOD * PERIOD
        if over > (started if until is None else until):
            until = over
    assert until is not None
    assert ledger["counts"] == {what: count for what, count in late.items() if count}
    assert (ledger["started"], ledger["integrated_to"], ledger["newest"]) == (started, until, newest)

    def on(begin: int, end: int) -> list[tuple[int, int]]:
        """When within this the robot was on: as long as any topic was heard less than MAX_GAP before."""
        pieces: list[tuple[int, int]] = []
        for at in sorted(at for times in taken.values() for at in times):
            a, b = max(at, begin), min(at + MAX_GAP, end)
            if a < b and pieces and a <= pieces[-1][1]:
                pieces[-1] = pieces[-1][0], max(pieces[-1][1], b)
            elif a < b:
                pieces.append((a, b))
        return pieces

    working = on(started, until)
    operating = sum(b - a for a, b in working) / HOUR
    totals = {name: [a + b for a, b in zip(*parts, strict=True)] for name, parts in ledger["totals"].items()}
    assert totals["clocks"][:2] == pytest.approx([operating, (until - started) / HOUR], rel=1e-12)
    for part, mode in enumerate(ledger["modes"]):
        topic = "/" + mode.partition(" ")[0]
        assert topic in TOPICS
        times = sorted(taken[topic])
        stressed = operating
        for at, following in pairwise([*times, until + MAX_AGE]):
            holds, silent = min(at + MAX_AGE, following, until), min(following, until)
            factor = 2 ** ((taken[topic][at] - 25) / 10)
            for begins, ends, aged in (
                (at, holds, factor),
                (holds, silent, max(factor, 1.0)),
            ):  # silence never improves
                stressed += (aged - 1) * sum(max(0, min(b, ends) - max(a, begins)) for a, b in working) / HOUR
        assert totals["age"][part] == pytest.approx(operating, rel=1e-12)
        assert totals["effective"][part] == pytest.approx(stressed, rel=1e-10)
