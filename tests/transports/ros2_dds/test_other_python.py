"""A ROS 2 is sourced whose rclpy was built for another Python: what it publishes is heard over DDS, which is said."""

from __future__ import annotations

import json
import math
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import Peer
from .test_watching import DESIGN, motor

__all__ = ["motor"]

LAUNCHED = Path(__file__).parents[3] / "ros" / "robophm_ros" / "src"


ABIS = ["of another ABI", "of no ABI that is known"]


def mostly(abi: str) -> pytest.MarkDecorator:
    """One of them; the other takes long too, and says what it says in another of these tests."""
    each = [abi, *(pytest.param(one, marks=pytest.mark.full) for one in ABIS if one != abi)]
    return pytest.mark.parametrize("sourced", each, indirect=True)


@pytest.fixture
def sourced(request: pytest.FixtureRequest, domain: int, tmp_path: Path) -> dict[str, str]:
    """The environment after a setup; its rclpy is laid out as ROS does, on a compiled extension that cannot be loaded.

    The extension is a real one, of NumPy, under the name that the rclpy of Python 3.9 has, or whose ABI no name tells.
    """
    prefix = tmp_path / "opt" / "ros" / "humble"
    package = prefix / "lib" / "python3.9" / "site-packages" / "rclpy"
    (package / "impl").mkdir(parents=True)
    (package / "__init__.py").write_text("from rclpy.impl.implementation_singleton import rclpy_implementation\n")
    (package / "impl" / "__init__.py").touch()
    (package / "impl" / "implementation_singleton.py").write_text(
        "import importlib\n\nrclpy_implementation = importlib.import_module('._rclpy_pybind11', package='rclpy')\n"
    )
    for name in ("context", "event_handler", "executors", "qos"):
        (package / f"{name}.py").write_text("from rclpy.impl.implementation_singleton import rclpy_implementation\n")
    compiled = next((Path(sys.modules["numpy"].__path__[0]) / "linalg").glob("_umath_linalg*.so"))
    tag = ".cpython-39-x86_64-linux-gnu" if request.param == "of another ABI" else ""
    shutil.copy(compiled, package / f"_rclpy_pybind11{tag}.so")
    return os.environ | {
        "ROS_VERSION": "2", "ROS_DISTRO": "humble", "AMENT_PREFIX_PATH": str(prefix),
        "PYTHONPATH": os.pathsep.join([str(package.parent), str(LAUNCHED), os.environ.get("PYTHONPATH", "")]),
    }  # fmt: skip


@pytest.mark.full
@mostly("of another ABI")
def test_topics_are_heard_and_it_is_said_why(
    motor: Peer, cyclonedds: None, sourced: dict[str, str], tmp_path: Path
) -> None:
    words = [sys.executable, "-m", "robophm", "topics", "--seconds", "2", "--json"]
    done = subprocess.run(
        words, cwd=tmp_path, env=sourced, capture_output=True, text=True, timeout=50, check=False
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith("listening to ROS 2 (ros2_dds): ROS_VERSION is 2; rclpy cannot be imported: the one in ")
    assert "/lib/python3.9/site-packages/rclpy does not run in Python 3." in line
    (heard,) = (info for info in json.loads(done.stdout)["topics"] if info["topic"] == "/motor")
    assert heard["values"]["temperature"] == 35


@mostly("of no ABI that is known")
def test_what_the_launch_file_runs_watches_and_says_each_line_at_once(
    motor: Peer, cyclonedds: None, sourced: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    (tmp_path / "robophm").write_text(f'#!/bin/sh\nexec {sys.executable} -m robophm "$@"\n')
    (tmp_path / "robophm").chmod(0o755)
    parameters = {"design": "robot.yaml", "robophm": str(tmp_path / "robophm"), "period": 0.5, "via": "ros2"}
    program = f"from robophm_ros.command import command; print('\\n'.join(command({parameters!r})))"
    found = subprocess.run([sys.executable, "-c", program], env=sourced, capture_output=True, text=True, check=True)
    process = subprocess.Popen(
        [*found.stdout.split("\n")[:-1], "--json", "--every", "0.5"],
        cwd=tmp_path, env=sourced, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    try:
        assert process.stderr is not None
        assert "(ros2_dds): as asked; rclpy cannot be imported: the one in" in process.stderr.readline()
        assert process.stdout is not None
        rate = math.nan
        for line in process.stdout:  # which it can read while the command runs, each a document
            rate = json.loads(line)["subjects"][0]["sensor_based"]["hazard_rate"]
            if rate == pytest.approx(0.02, rel=1e-9):
                break
        assert rate == pytest.approx(0.02, rel=1e-9)
        assert process.poll() is None
    finally:
        process.send_signal(signal.SIGINT)
        _, warned = process.communicate(timeout=50)
    assert process.returncode == 0, warned


@pytest.mark.full
@pytest.mark.parametrize("sourced", ABIS, indirect=True)
def test_without_the_wheel_it_is_said_which_rclpy_it_is(sourced: dict[str, str], tmp_path: Path) -> None:
    """The wheel is hidden by a name that cannot be found, as on a machine that has none."""
    hide = "import importlib.util as u, runpy, sys; find = u.find_spec\n"
    hide += "u.find_spec = lambda name, *rest: None if name == 'cyclonedds' else find(name, *rest)\n"
    hide += "sys.argv = ['robophm', 'topics']; runpy.run_module('robophm', run_name='__main__')"
    done = subprocess.run(
        [sys.executable, "-c", hide], cwd=tmp_path, env=sourced, capture_output=True, text=True, timeout=50, check=False
    )
    assert done.returncode == 3
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: rclpy cannot be imported: the one in ")
    assert line.endswith("and no cyclonedds: pip install robophm[ros2]")
