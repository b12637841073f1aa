"""A behaviour tree of py_trees in a rospy node that asks before it drives, and the service that answers it."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from robophm.design.file import parse
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.transports.health_topics import Outlet, TaskService
from robophm.transports.ros1 import Node, Publisher, Service

from .conftest import System

SOURCE = Path(__file__).parents[3] / "ros" / "robophm_ros" / "src"
DESIGN = """
schema_version: 1
name: R
thresholds: {completion: 0.9}
components: {motor: {rate: 0.1 /h}}
"""
TREE = """
import json, time, py_trees
from phm_msgs.srv import AssessTask
from phm_msgs.msg import TaskLeg
from robophm_ros.behaviours import MayDo
rospy.init_node("robot", anonymous=True)
say("ready")
service = rospy.ServiceProxy("/phm/assess_task", AssessTask)
rospy.wait_for_service("/phm/assess_task", 60)
board = py_trees.blackboard.Client(name="test")
for key in ("legs", "assessment"):
    board.register_key(key, access=py_trees.common.Access.WRITE)
def outcome(hours, prefix=False, functions=()):
    board.legs = [TaskLeg(duration=h, functions=list(functions)) for h in hours]
    may = MayDo(lambda legs: service(legs, 0, 0), prefix=prefix)
    drive, home = py_trees.behaviours.Success("drive"), py_trees.behaviours.Success("home")
    go = py_trees.composites.Sequence("go", memory=True, children=[may, drive])
    root = py_trees.composites.Selector("root", memory=True, children=[go, home])
    tree = py_trees.trees.BehaviourTree(root)
    tree.tick()
    while root.status == py_trees.common.Status.RUNNING:
        time.sleep(0.01); tree.tick()
    done = "drive" if drive.status == py_trees.common.Status.SUCCESS else "home"
    tree.shutdown()
    say(json.dumps([done, len(board.legs), board.assessment.completion_sensor_based, may.feedback_message]))
outcome([0.5])
outcome([2.0])
outcome([0.5, 0.25, 2.0], prefix=True)
outcome([0.5], functions=["fly"])
"""


@pytest.fixture
def served(ros: System, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("ROS_MASTER_URI", ros.uri)
    monkeypatch.setenv("ROS_IP", "127.0.0.1")
    outlet = Outlet(1, Node, Publisher, Service)
    TaskService(outlet, TaskAssessor(parse(DESIGN)))
    yield
    outlet.close()


def test_a_tree_drives_what_may_be_done_and_goes_home_otherwise(ros: System, served: None, services_path: Path) -> None:
    """At 0.1 /h half an hour succeeds with exp(−0.05), two hours with exp(−0.2), where 0.9 is wanted."""
    found = importlib.util.find_spec("py_trees")
    if found is None or found.origin is None:
        pytest.skip("no py_trees (pip install py_trees)")
    paths = [str(services_path), str(SOURCE)]
    code = f"sys.path[:0] = {paths!r}\nsys.path.append({str(Path(found.origin).parents[1])!r})\n"
    process = ros.talk(code + TREE)
    assert process.stdout is not None
    short, long, begun, unknown = [json.loads(line) for line in process.stdout]
    assert short[:3] == ["drive", 1, pytest.approx(0.951229424500714)]
    assert long[:3] == ["home", 1, pytest.approx(0.8187307530779818)]
    assert begun[:2] == ["drive", 2]  # exp(−0.075) is enough, exp(−0.275) is not
    assert unknown[0] == "home"
    assert "fly" in unknown[3]
