"""``robophm watch --fleet``: a robot that runs, beside the server of Foxglove's own SDK, reports to a service."""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
import threading

import pytest
from tests.fleet.conftest import wait_for
from tests.transports.foxglove.conftest import Robot

from robophm.cli.shared.fleet import TOKEN
from robophm.fleet.questions import present, reports, worst
from robophm.stores.sqlite import SqliteStore

DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: data, unit: degC}}
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""


@pytest.mark.full
def test_a_robot_that_runs_reports(fleet, store, tmp_path):
    (tmp_path / "robot.yaml").write_text(DESIGN)
    token, robot, over = store.add_token("r"), Robot(), threading.Event()
    channel = robot.channel("/motor", "std_msgs/msg/Float64", "float64 data\n")

    def speak():
        while not over.wait(0.05):
            channel.log(b"\0\1\0\0" + struct.pack("<d", 35.0))

    speaking = threading.Thread(target=speak, daemon=True)
    speaking.start()
    words = ["watch", "robot.yaml", "--via", robot.place, "--no-publish", "--store", "robot.db",
             "--fleet", f"{fleet.address}robots/r"]  # fmt: skip
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", *words], cwd=tmp_path, env={**os.environ, TOKEN: token}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        wait_for(lambda: [*reports(store)])
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=60)
        over.set()
        speaking.join()
        robot.close()
    assert process.returncode == 0, warned
    assert "fleet" not in warned
    with SqliteStore(tmp_path / "robot.db") as kept:
        ledger = kept._base.execute("SELECT state FROM ledger").fetchone()[0]
    assert present(store, "r")[0] == ledger  # the last save, with what was heard until the end
    (one,) = worst(store, 24.0, 5).robots
    # 0.02 /h, as 10 °C more doubles it: the engine's figure in closed form, 1 − exp(−0.02·24)
    assert one.chance == pytest.approx(0.381217, rel=1e-3)
    assert one.first == "motor"
