"""A page speaks of every command, and each that it and the first page print runs so in a folder of one's own."""

import math
import os
import re
import shlex
import shutil
import signal
import subprocess
import sysconfig
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.cli.app import COMMANDS
from robophm.core.signal import SECOND

from ..cli.conftest import run_inside

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
TEXT = (ROOT / "docs" / "reference" / "which-command.md").read_text(encoding="utf-8")
ONES_OWN = ROOT / "tests" / "data" / "readme"
CELLS = [row.split("|")[1] for row in TEXT.splitlines() if row.startswith("| `robophm")]
FIRST = [line for block in re.findall(r"```bash\n(.*?)```", README, re.S) for line in block.splitlines()]
PRINTED = FIRST + [command for cell in CELLS for command in re.findall(r"`(robophm [^`]+)`", cell)]
BREACHED = {"wear": (0, 1), "calibrate": (0, 1)}
"""Exit codes of commands that may well say that a threshold is breached; 0 of others, and 130 of those stopped."""
STOPPED = {"watch", "serve"}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_on_the_page(command: str) -> None:
    assert any(printed.split()[1] == command for printed in PRINTED)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, write_messages: Callable[..., Path]) -> Path:
    """The page's robot, recordings of three days, and tables as its guides describe them."""
    here = tmp_path_factory.mktemp("courier")
    (block,) = re.findall(r"```yaml\n(.*?)```", TEXT, re.S)
    (here / "robot.yaml").write_text(block, encoding="utf-8")
    shutil.copytree(ONES_OWN, here, dirs_exist_ok=True)
    shutil.copytree(ROOT / "examples", here / "examples")
    shutil.copy(ROOT / "tests" / "data" / "legacy_ota.yaml", here / "phm_configurations.yaml")
    (here / "bags").mkdir()
    for day in range(3):
        write_messages(here / "bags" / f"day{day}.mcap", drive(day))
    shutil.copy(here / "bags" / "day0.mcap", here / "drive.mcap")
    return here


def header(types: dict[str, Any], at: int) -> object:
    return types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](at, 0), "base")


def warm(at: int, hot: float, types: dict[str, Any]) -> object:
    return types["sensor_msgs/msg/Temperature"](header(types, at), hot, 0.0)


def moved(at: int, metres: float, types: dict[str, Any]) -> object:
    def kind(name: str) -> Any:
        return types[f"geometry_msgs/msg/{name}"]

    pose = kind("Pose")(kind("Point")(metres, 0.0, 0.0), kind("Quaternion")(0.0, 0.0, 0.0, 1.0))
    twist = kind("Twist")(kind("Vector3")(0.4, 0.0, 0.0), kind("Vector3")(0.0, 0.0, 0.0))
    unknown = np.zeros(36)
    placed, moving = kind("PoseWithCovariance")(pose, unknown), kind("TwistWithCovariance")(twist, unknown)
    return types["nav_msgs/msg/Odometry"](header(types, at), "base", placed, moving)


def drive(day: int) -> list[tuple[str, str, int, Callable[..., object]]]:
    """Four hours of a day, of what the design binds, every minute."""
    start = 1_780_000_000 + day * 86_400
    messages: list[tuple[str, str, int, Callable[..., object]]] = []
    for at in range(start, start + 14_400, 60):
        hot = 40 + 10 * math.sin(at / 4000)
        messages.append(("/motors/temperature", "sensor_msgs/msg/Temperature", at * SECOND, partial(warm, at, hot)))
        messages.append(("/odom", "nav_msgs/msg/Odometry", at * SECOND, partial(moved, at, 0.4 * (at - start))))
    return messages


def is_stopped(command: str) -> bool:
    """Whether a command, or one of a group, runs until somebody stops it."""
    return not STOPPED.isdisjoint(command.split()[1:3])


def ended(command: str, folder: Path) -> tuple[int, str]:
    """Exit code and output of a command; one that runs until stopped is a process of its own, and is stopped."""
    if not is_stopped(command):
        with pytest.MonkeyPatch.context() as changed:
            changed.setenv("NO_COLOR", "1")
            done = run_inside(folder, shlex.split(command)[1:], changed)
        return done.returncode, done.stdout + done.stderr
    if "serve" in command.split():  # its own port may be taken by whoever else runs on this machine
        command += " --port 0"
    environment = {**os.environ, "PATH": f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}", "NO_COLOR": "1"}
    process = subprocess.Popen(
        ["sh", "-c", f"exec {command}"],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        for _ in range(100):  # a signal that comes too early may be lost
            try:
                process.wait(5)
                break
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=600)
    except BaseException:
        process.kill()
        process.communicate()
        raise
    return process.returncode, output


def test_commands_run_as_printed(folder: Path) -> None:
    """All of them in their order: one finds what another left."""
    wrong = []
    once = {command.split()[1] for command in PRINTED if is_stopped(command)}
    for command in PRINTED:
        if is_stopped(command) and command.split()[1] not in once:
            continue  # it runs until it is stopped, which takes seconds: one of each will do
        once.discard(command.split()[1])
        code, output = ended(command, folder)
        if code not in ((0, 130) if is_stopped(command) else BREACHED.get(command.split()[1], (0,))):
            wrong.append(f"{command}: exit {code}\n{output[-600:]}")
        assert "Traceback" not in output, f"{command}\n{output}"
    assert not wrong, "\n\n".join(wrong)
