"""``robophm watch`` beside a real roscore: what is lost is told while it happens, and the task ahead from the start."""

from __future__ import annotations

import json
import math
import os
import pty
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import pytest

from ..listener import within
from .conftest import System
from .genpy import ROOT, generated

DESIGN = """
schema_version: 1
name: R
task: {duration: 2 h}
signals: {temperature: {topic: /motor, field: temperature, unit: degC, range: [-40, 125]}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""
GAPS = (3, 30, 300)
"""Messages that are missing each time: each time ten times as many, so that each is told of in the log."""

TALKER = """
import threading, time
rospy.init_node("motor", anonymous=True)
out = rospy.Publisher("/motor", Temperature, queue_size=1000)  # a busy machine makes no gap of its own
heard(out)
say("ready")
def skip():
    for line in sys.stdin:
        out.impl.seq += int(line); say(time.time())
threading.Thread(target=skip, daemon=True).start()
while not rospy.is_shutdown():
    out.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=25.0)); time.sleep(0.05)
"""
READER = """
import json, time
from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Log
rospy.init_node("reader", anonymous=True)
def told(where, words):
    say(json.dumps([where, time.time(), words]))
rospy.Subscriber("/rosout", Log, lambda m: told("log", m.msg))
rospy.Subscriber("/diagnostics", DiagnosticArray,
                 lambda m: [told("diagnostics", s.message) for s in m.status if s.name.endswith("listening")])
say("ready")
rospy.spin()
"""


@contextmanager
def watched(ros: System, folder: Path) -> Iterator[list[tuple[float, str]]]:
    """A watcher on a terminal; what it writes there, and when."""
    (folder / "robot.yaml").write_text(DESIGN)
    ours, its = pty.openpty()
    wide = {"COLUMNS": "200", "TERM": "xterm", "PATH": os.environ["PATH"]}
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", "watch", "robot.yaml", "--via", "ros1"], cwd=folder,
        env=os.environ | ros.environment | wide, stdout=its, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(its)
    written: list[tuple[float, str]] = []

    def read() -> None:
        with suppress(OSError):  # it has ended
            while some := os.read(ours, 1 << 16):
                written.append((time.time(), some.decode(errors="replace")))

    reading = threading.Thread(target=read)
    reading.start()
    try:
        yield written
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(60)
        reading.join()
        os.close(ours)


def test_what_is_lost_is_told_within_a_second(system: System, tmp_path: Path) -> None:
    """On the terminal, on /diagnostics and on /rosout: at the best of three times, for the machine may be busy."""
    system.start_master()  # its own: at one that others used there are publishers that never answer
    reader = system.talk(READER)
    found: list[tuple[str, float, str]] = []
    assert reader.stdout is not None
    lines = iter(reader.stdout.readline, "")
    threading.Thread(target=lambda: found.extend(tuple(json.loads(line)) for line in lines), daemon=True).start()
    took: dict[str, list[float]] = {"log": [], "diagnostics": [], "terminal": []}
    with watched(system, tmp_path) as written:
        talker = system.talk(TALKER)
        assert talker.stdin is not None
        assert talker.stdout is not None

        def first(where: str, after: float) -> list[float]:
            known = [("terminal", *one) for one in written] if where == "terminal" else list(found)
            return [t for w, t, said in known if w == where and t > after and "sequence gap on /motor" in said]

        within(20, lambda: any("h of operation" in words for _, words in written))
        within(20, lambda: "diagnostics" in {where for where, *_ in found})  # rospy has connected
        for gap in GAPS:
            talker.stdin.write(f"{gap}\n")
            talker.stdin.flush()
            at = float(talker.stdout.readline())
            for where, times in took.items():
                try:
                    within(10, partial(first, where, at))
                except AssertionError:
                    pytest.fail(f"{gap} lost at {at} are not told by {where}: {found[-20:]}, {written[-3:]}")
                times.append(first(where, at)[0] - at)
    assert {where: round(min(times), 2) for where, times in took.items() if min(times) > 1} == {}


@pytest.mark.full
def test_before_there_is_a_time_it_is_told_that_nothing_counts(system: System, tmp_path: Path) -> None:
    """Under use_sim_time, as long as nobody publishes /clock."""
    system.start_roscore()
    system.run("/usr/bin/rosparam", "set", "/use_sim_time", "true")
    reader = system.talk(READER)
    assert reader.stdout is not None
    with watched(system, tmp_path):
        system.talk(TALKER.replace("heard(out)\n", ""))
        for line in reader.stdout:
            where, _, words = json.loads(line)
            if where == "log" and "before the first time of /clock, dropped /motor" in words:
                break


@pytest.fixture(scope="module")
def python_path(roscore: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    ours = {file.stem: file.read_text() for file in [*(ROOT / "msg").iterdir(), *(ROOT / "ros1" / "msg").iterdir()]}
    return generated(tmp_path_factory.mktemp("new"), **ours)


@pytest.mark.full
def test_the_designs_task_is_predicted_in_the_first_message(system: System, tmp_path: Path, python_path: Path) -> None:
    """Two hours at 0.01 /h, as there is nothing else yet; of a task that was done nothing is known."""
    system.start_master()  # its own: it would tell of this reader for ever
    reader = system.talk(f"""
sys.path.insert(0, {str(python_path)!r})
import json
from phm_msgs.msg import Potc
rospy.init_node("reader", anonymous=True)
rospy.Subscriber("/phm_potc", Potc, lambda m: say(json.dumps([
    m.predict_potc.potc_nominal_value, m.predict_potc.potc_sensor_based_value, m.actual_potc.potc_nominal_value])))
say("ready")
rospy.spin()
""")
    assert reader.stdout is not None
    with watched(system, tmp_path):
        nominal, lived, done = json.loads(reader.stdout.readline())
    assert nominal == pytest.approx(math.exp(-0.02), rel=1e-6)
    assert lived == pytest.approx(math.exp(-0.02), rel=1e-6)
    assert math.isnan(done)
