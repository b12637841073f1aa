"""A machine whose clock lies beside one whose clock is right: both hear the same robot, and know the same of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from robophm.core.signal import CLOCK, HOUR, SECOND
from robophm.design.file import parse
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.journal import JournalRecording

from ..listener import within
from .conftest import System
from .test_watching import DESIGN, ended, spoken

TOLD = 240
TALKER = f"""
rospy.init_node("motor", anonymous=True)
out = rospy.Publisher("/motor", Temperature, queue_size=100)
say("ready")
heard(out, 2)
for number in range({TOLD}):
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=30 + number % 37)); rospy.sleep(0.05)
rospy.sleep(30)
"""

LIAR = """
import pathlib, sys, time
true, by = time.time_ns, pathlib.Path("off.txt")
time.time_ns = lambda: true() + int(by.read_text() or 0)
from robophm.cli import main
main()
"""
"""The command on a machine whose clock is off by what a file says [ns]."""


def lies() -> list[int]:
    """By how much the clock is off, each for so long: eight ways of being wrong, and right in between [ns]."""
    now = time.time_ns()
    to_2038, to_1970 = 2_147_483_000 * SECOND - now, -now
    to_and_fro = [HOUR, -HOUR, to_2038, to_1970] * 2
    return [to_2038, 0, -HOUR, 0, 3 * SECOND, 0, -3 * SECOND, 0, -SECOND, 0, to_1970, 0, 12 * HOUR, 0, *to_and_fro, 0]


@pytest.mark.full
def test_a_clock_that_lies_in_eight_ways_changes_nothing(ros: System, tmp_path: Path) -> None:
    off = tmp_path / "off.txt"
    off.write_text("0")
    (tmp_path / "robot.yaml").write_text(DESIGN)

    def watching(name: str, *program: str) -> subprocess.Popen[str]:
        words = ["watch", "robot.yaml", "--no-publish", "--store", f"{name}.db", "--journal", f"{name}.journal"]
        return subprocess.Popen(
            [sys.executable, *program, *words], cwd=tmp_path, text=True,
            env=os.environ | ros.environment | {"PATH": os.environ["PATH"]},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )  # fmt: skip

    watchers = {"right": watching("right", "-m", "robophm"), "lying": watching("lying", "-c", LIAR)}
    ros.talk(TALKER)
    try:
        within(30, lambda: all(spoken(tmp_path / f"{name}.journal") for name in watchers))
        for by in lies():
            new = tmp_path / "new.txt"
            new.write_text(str(by))
            new.replace(off)
            time.sleep(0.4)
        within(30, lambda: all(spoken(tmp_path / f"{name}.journal") == TOLD for name in watchers))
    finally:
        warned = {name: ended(process, signal.SIGTERM) for name, process in watchers.items()}
    assert [code for code, *_ in warned.values()] == [0, 0], warned
    assert "the clock was set forward; time went on as it was" in warned["lying"][2]
    robot = parse(DESIGN)
    heard, hours = {}, {}
    for name in watchers:
        recording, again = JournalRecording(tmp_path / f"{name}.journal"), MemoryStore()
        replay(robot, recording, store=again, period=1.0)
        with SqliteStore(tmp_path / f"{name}.db") as store:
            ledger = store.ledger("R")
        assert ledger
        assert ledger == again.ledger("R")
        assert not ledger["counts"]
        assert ("suspect_time" in ledger) == (name == "lying")
        heard[name] = [one for one in recording.samples(robot.signals) if one.signal != CLOCK]
        hours[name] = np.sum(ledger["totals"]["clocks"], axis=0)
    assert heard["lying"] == heard["right"]
    assert hours["lying"] == pytest.approx(hours["right"], abs=120 / 3600)  # one was ended after the other
