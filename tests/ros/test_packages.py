"""The packages for ROS: what catkin, roslaunch and SMACH make of them, where those are here."""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import threading
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import yaml

from ..transports.listener import within

ROS = Path(__file__).parents[2] / "ros"
SYSTEM = {**os.environ, "PATH": "/usr/bin:/bin", "ROS_PACKAGE_PATH": str(ROS)}


def module(name: str) -> Any:
    """A file of robophm_ros, which is no package of ours."""
    path = ROS / "robophm_ros" / "src" / "robophm_ros" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"robophm_ros_{name}", path)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


@pytest.mark.parametrize(
    ("version", "tool", "build_type"), [("1", "catkin", "catkin"), ("2", "ament_cmake", "ament_cmake")]
)
@pytest.mark.parametrize("package", ["phm_msgs", "robophm_ros"])
def test_package_files_are_of_both_generations(package: str, version: str, tool: str, build_type: str) -> None:
    """As catkin_pkg reads them, of Debian's Python."""
    code = (
        "import json, sys; from catkin_pkg.package import parse_package; p = parse_package(sys.argv[1]);"
        "p.evaluate_conditions({'ROS_VERSION': sys.argv[2]});"
        "print(json.dumps([p.name, p.package_format, [d.name for d in p.buildtool_depends if d.evaluated_condition],"
        "p.get_build_type(), [g.name for g in p.member_of_groups if g.evaluated_condition]]))"
    )
    command = ["/usr/bin/python3", "-c", code, str(ROS / package), version]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if "No module named 'catkin_pkg'" in done.stderr:
        pytest.skip("no catkin_pkg here")
    name, form, tools, found, groups = json.loads(done.stdout)
    assert (name, form, found) == (package, 3, tool)
    assert tool in tools
    assert groups == (["rosidl_interface_packages"] if (package, version) == ("phm_msgs", "2") else [])


def test_messages_of_both_generations_differ_in_time_alone() -> None:
    for old in (ROS / "phm_msgs" / "ros1" / "msg").iterdir():
        new = ROS / "phm_msgs" / "msg" / old.name
        assert old.read_text().replace("time stamp", "builtin_interfaces/Time stamp") == new.read_text()


def test_parameters_become_a_command() -> None:
    command = module("command").command
    given = {"design": "robot.yaml", "period": 0.5, "store": "", "journal": "a b.journal", "tasks": ["/plan", ""]}
    assert command(given) == [
        "robophm", "watch", "robot.yaml", "--namespace", "/", "--period", "0.5", "--journal", "a b.journal",
        "--tasks", "/plan",
    ]  # fmt: skip
    assert command({"design": "r", "robophm": "/opt/x/robophm", "namespace": "/r2"})[:5] == [
        "/opt/x/robophm", "watch", "r", "--namespace", "/r2",
    ]  # fmt: skip
    assert command({"design": "r", "store": "past.db", "reports": True})[-3:] == ["--store", "past.db", "--reports"]
    assert command({"design": "r", "robot": "amr_7"})[3:] == ["--robot", "amr_7"]
    assert command({"design": "r", "robots": "amr_*"}, "/hall")[3:] == ["--robots", "amr_*"]
    for namespace, parameter, root in (("/amr_7/", "", "/amr_7"), ("/amr_7", "/hall", "/hall"), ("/", "", "/")):
        assert command({"design": "r", "namespace": parameter}, namespace)[4] == root
    with pytest.raises(ValueError, match="parameter 'design' is missing"):
        command({})


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="prctl is of Linux")
def test_a_node_that_is_killed_leaves_no_watcher() -> None:
    """Its command ends with it, though it could not be told to."""
    source = ROS / "robophm_ros" / "src"
    code = (
        f"import sys; sys.path.insert(0, {str(source)!r}); from robophm_ros.command import start;"
        "print(start(['sleep', '600']).pid, flush=True); input()"
    )
    command = [sys.executable, "-B", "-c", code]
    node = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert node.stdout is not None
    watcher = int(node.stdout.readline())
    running = Path(f"/proc/{watcher}/stat")
    assert running.read_text().split()[2] in "SR"
    node.kill()
    node.communicate()
    within(10, lambda: not running.exists() or running.read_text().split()[2] in "ZX")


def test_the_options_that_parameters_become_are_those_of_watch() -> None:
    import typer

    from robophm.cli.app import app

    watch: Any = typer.main.get_command(app).get_command(None, "watch")  # type: ignore[attr-defined]
    options = {option for parameter in watch.params for option in parameter.opts if option.startswith("--")}
    parameters = {"namespace", "reports", *module("command").FLAGS, *module("command").LISTS}
    # its output is for people, and a node publishes: else nothing were to be launched
    assert options - {"--json", "--publish"} == {f"--{name}" for name in parameters}
    for file in ("launch/robophm.launch", "launch/robophm.launch.py", "scripts/robophm_lifecycle"):
        text = (ROS / "robophm_ros" / file).read_text()
        assert [name for name in parameters if f'"{name}"' not in text] == []


def test_roslaunch_reads_the_launch_file(tmp_path: Path) -> None:
    if not shutil.which("roslaunch", path="/usr/bin"):
        pytest.skip("no roslaunch here")
    command = ["roslaunch", "robophm_ros", "robophm.launch", "--nodes", "design:=robot.yaml"]
    environment = {**SYSTEM, "HOME": str(tmp_path), "ROS_HOME": str(tmp_path)}
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment, timeout=60)
    assert done.stdout.split() == ["/robophm"]
    command[3:] = ["--dump-params", "design:=robot.yaml", "tasks:=[/plan, /odom]", "speed:=0.3 m/s"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment, timeout=60)
    given = {name.removeprefix("/robophm/"): value for name, value in yaml.safe_load(done.stdout).items()}
    words = module("command").command(given)
    assert words[:3] == ["robophm", "watch", "robot.yaml"]
    assert words[-4:] == ["--tasks", "/plan", "--tasks", "/odom"]
    assert ("--speed", "0.3 m/s") in pairwise(words)


def test_smach_states_drive_a_task_and_tell_of_it() -> None:
    pytest.importorskip("smach", reason="SMACH is on no package index; tried against its public sources")
    tasks = [[[0, 0, 0.5], [3, 4, 0.5], [3, 0, 1]], [[0, 0, 1], [9, 9, 1]]]
    place, said = [0.0, 0.0], {}

    def drive(x: float, y: float, _: float) -> bool:
        if x == 9:
            return False
        place[:] = [x, y]
        return True

    machine = module("smach_states").executive(
        lambda: tasks.pop(0) if tasks else None, drive, lambda: tuple(place), said.setdefault, wait=0.01
    )
    threading.Timer(0.5, machine.request_preempt).start()
    assert machine.execute() == "preempted"
    assert json.loads(said["/task_position"]) == [[0, 0], [3, 4], [3, 0]]
    assert len(json.loads(said["/task_time"])) == 2


@pytest.mark.full
def test_catkin_builds_both(tmp_path: Path) -> None:
    if not shutil.which("catkin_make", path="/usr/bin") or not Path("/usr/share/message_generation").exists():
        pytest.skip("no catkin with message generation here")
    (tmp_path / "src").mkdir()
    for package in ("phm_msgs", "robophm_ros"):
        (tmp_path / "src" / package).symlink_to(ROS / package)
    environment = {**SYSTEM, "ROS_VERSION": "1", "HOME": str(tmp_path), "PWD": str(tmp_path)}  # where it builds
    command = ["catkin_make", "-DPYTHON_EXECUTABLE=/usr/bin/python3"]
    subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, check=True, timeout=500)
    made = tmp_path / "devel" / "lib" / "python3" / "dist-packages"
    assert (made / "phm_msgs" / "msg" / "_Health.py").exists()
    assert (made / "robophm_ros").exists()


def test_layouts_are_json_and_show_topics_that_are_published() -> None:
    layout = json.loads((ROS / "robophm_ros" / "config" / "foxglove.json").read_text())
    told = json.dumps(layout)
    for topic in ("/phm_hazard_rate", "/phm_reliability", "/phm_potc", "/diagnostics", "/phm/markers"):
        assert topic in told
    assert "/phm/markers" in (ROS / "robophm_ros" / "config" / "health_ros1.rviz").read_text()
