"""Goals of Nav2 and move_base, in recordings that have the messages as those define them."""

from __future__ import annotations

import math
import re
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from robophm.core.signal import HOUR, SECOND
from robophm.transports.recordings.recording import Recording
from robophm.transports.tasks import DoneLeg, DoneTask, PlannedLeg, PlannedTask, TaskTopics, tasks_of

T0 = 1_700_000_000 * SECOND
ONE = "01010101-0101-0101-0101-010101010101"
"""The name of a goal of sixteen bytes of 1, as ros2 action shows it."""

HUMBLE = """
geometry_msgs/PoseStamped current_pose
builtin_interfaces/Duration navigation_time
builtin_interfaces/Duration estimated_time_remaining
int16 number_of_recoveries
float32 distance_remaining
"""
"""The feedback of nav2_msgs/action/NavigateToPose, nav2 1.1 to 1.4; later ones append to it."""
LYRICAL = HUMBLE + "float32 position_tracking_error\nfloat32 heading_tracking_error\n"
WAYPOINTS = "uint32 current_waypoint\n"
MOVE_BASE = {
    "MoveBaseGoal": "geometry_msgs/PoseStamped target_pose",
    "MoveBaseFeedback": "geometry_msgs/PoseStamped base_position",
    "MoveBaseResult": "",
    "MoveBaseActionGoal": "Header header\nactionlib_msgs/GoalID goal_id\nMoveBaseGoal goal",
    "MoveBaseActionFeedback": "Header header\nactionlib_msgs/GoalStatus status\nMoveBaseFeedback feedback",
    "MoveBaseActionResult": "Header header\nactionlib_msgs/GoalStatus status\nMoveBaseResult result",
}
"""move_base_msgs 1.14, as genaction makes it."""


class Tape:
    """Records messages that are given as mappings of their fields."""

    def __init__(self, path: Path, types: dict[str, str]) -> None:
        from rosbags.rosbag1 import Writer as Writer1
        from rosbags.rosbag2 import Writer as Writer2
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore

        self.path = path
        self.ros1 = path.suffix == ".bag"
        self.store: Any = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_JAZZY)
        self.texts = {name: self._whole(text, types) for name, text in types.items()}
        found: dict[str, Any] = {}
        for name, text in types.items():
            found |= get_types_from_msg(text, name)
        self.store.register(found)
        self.writer: Any = Writer1(path) if self.ros1 else Writer2(path, version=9)
        self.writer.open()
        self.connections: dict[str, Any] = {}

    def _whole(self, text: str, types: dict[str, str]) -> str:
        """With the texts of the types in it, as recordings have it."""
        known = [name.replace("/msg/", "/") for name in self.store.types]
        parts = [name for name in (*types, *known) if re.search(rf"^{name} ", text, re.M)]
        if not self.ros1 and parts:
            inner = [types.get(name) or self.store.generate_msgdef(name.replace("/", "/msg/"), ros_version=2)[0]
                     for name in parts]  # fmt: skip
            return text + "".join(f"\n{'=' * 80}\nMSG: {name}\n{self._whole(each, types) if name in types else each}"
                                  for name, each in zip(parts, inner, strict=True))  # fmt: skip
        return text

    def say(self, after: float, topic: str, type_: str, **fields: Any) -> None:
        from robophm.transports.health_topics.message_of_fields import compose

        message = compose(self.store, type_, fields)
        if topic not in self.connections:
            own = {}
            if "/action/" in type_:  # of which rosbags makes no text
                own = {"msgdef": self.texts[type_], "rihs01": f"RIHS01_{0:064}"}
            self.connections[topic] = self.writer.add_connection(topic, type_, typestore=self.store, **own)
        raw = (self.store.serialize_ros1 if self.ros1 else self.store.serialize_cdr)(message, type_)
        self.writer.write(self.connections[topic], T0 + round(after * SECOND), raw)

    def tasks(self, *topics: str) -> tuple[list[PlannedTask | DoneTask], Counter[str]]:
        self.writer.close()
        with Recording(self.path) as recording:
            return list(tasks_of(recording, topics or None)), Counter(recording.notes)


def pose(x: float, y: float) -> dict[str, Any]:
    return {"pose": {"position": {"x": x, "y": y}}}


def span(seconds: int) -> dict[str, int]:
    return {"sec": seconds, "nanosec": 0}


@pytest.mark.parametrize("text", [HUMBLE, LYRICAL], ids=["Humble", "Lyrical"])
def test_nav2(tmp_path: Path, text: str) -> None:
    action = "nav2_msgs/action/NavigateToPose"
    tape = Tape(tmp_path / "drive", {
        f"{action}_Feedback": text,
        f"{action}_FeedbackMessage": f"unique_identifier_msgs/UUID goal_id\n{action}_Feedback feedback",
    })  # fmt: skip
    where = "/navigate_to_pose/_action"
    one, other = ({"uuid": [number] * 16} for number in (1, 2))

    def feedback(after: float, goal: Any, place: tuple[float, float], left: float, since: int, ahead: int) -> None:
        tape.say(after, f"{where}/feedback", f"{action}_FeedbackMessage", goal_id=goal, feedback={
            "current_pose": pose(*place), "distance_remaining": left, "navigation_time": span(since),
            "estimated_time_remaining": span(ahead),
        })  # fmt: skip

    def status(after: float, **states: int) -> None:
        goals = {"one": one, "other": other}
        tape.say(after, f"{where}/status", "action_msgs/msg/GoalStatusArray", status_list=[
            {"goal_info": {"goal_id": goals[name]}, "status": state} for name, state in states.items()
        ])  # fmt: skip

    status(10, one=2)
    feedback(11, one, (0, 0), 0.0, 1, 0)  # no path yet
    feedback(12, one, (3, 4), 20.0, 2, 40)
    feedback(13, one, (3, 16), 8.0, 3, 16)
    status(14, one=4)
    feedback(14.1, one, (3, 17), 0.0, 4, 0)  # still on the way when it was done
    status(15, one=4, other=2)
    feedback(16, other, (0, 0), 5.0, 0, 0)
    status(18, one=4, other=6)
    tasks, notes = tape.tasks()
    topic = f"{where}/feedback"
    assert tasks == [
        PlannedTask(T0 + 12 * SECOND, topic, (PlannedLeg(20.0, 0.5),), ONE),
        DoneTask(T0 + 10 * SECOND, T0 + 14 * SECOND, f"{where}/status", (DoneLeg(17.0, 4 * SECOND / HOUR),), ONE),
        PlannedTask(T0 + 16 * SECOND, topic, (PlannedLeg(5.0, None),), ONE.replace("1", "2")),
    ]
    assert notes == {"goal on /navigate_to_pose ended without success": 1}


def test_move_base(tmp_path: Path) -> None:
    tape = Tape(tmp_path / "drive.bag", {f"move_base_msgs/msg/{name}": text for name, text in MOVE_BASE.items()})
    goal = {"goal_id": {"id": "/nav-1"}}
    tape.say(1, "/move_base/goal", "move_base_msgs/msg/MoveBaseActionGoal", goal_id=goal["goal_id"],
             goal={"target_pose": pose(6, 8)})  # fmt: skip
    for after, x, y in ((2, 0, 0), (4, 3, 4), (6, 6, 8)):
        tape.say(after, "/move_base/feedback", "move_base_msgs/msg/MoveBaseActionFeedback",
                 status={**goal, "status": 1}, feedback={"base_position": pose(x, y)})  # fmt: skip
    tape.say(7, "/move_base/status", "actionlib_msgs/msg/GoalStatusArray", status_list=[{**goal, "status": 1}])
    tape.say(8, "/move_base/result", "move_base_msgs/msg/MoveBaseActionResult", status={**goal, "status": 3})
    tape.say(9, "/move_base/status", "actionlib_msgs/msg/GoalStatusArray", status_list=[{**goal, "status": 3}])
    tasks, notes = tape.tasks("/move_base")
    assert tasks == [
        PlannedTask(T0 + 2 * SECOND, "/move_base/feedback", (PlannedLeg(10.0, None),), "/nav-1"),
        DoneTask(T0 + 2 * SECOND, T0 + 8 * SECOND, "/move_base/result", (DoneLeg(10.0, 6 * SECOND / HOUR),), "/nav-1"),
    ]
    assert not notes


class Message:
    """As rosbags decodes one: a type's name, and attributes."""

    def __init__(self, type_: str = "", **fields: Any) -> None:
        self.__msgtype__ = type_
        vars(self).update(fields)


def at(x: float, y: float) -> Message:
    position = Message(x=x, y=y)
    return Message("nav_msgs/msg/Odometry", pose=Message(pose=Message(position=position)))


def test_waypoints_take_their_distance_from_odometry_or_are_counted() -> None:
    goal = Message(uuid=[7] * 16)
    feedback = Message("nav2_msgs/action/FollowWaypoints_FeedbackMessage", goal_id=goal, feedback=Message(current=1))
    over = Message("action_msgs/msg/GoalStatusArray",
                   status_list=[Message(goal_info=Message(goal_id=goal), status=4)])  # fmt: skip
    for odometry in (False, True):
        topics = TaskTopics()
        found = []
        for second, (place, message) in enumerate(((at(0, 0), feedback), (at(3, 4), feedback), (at(3, 5), over))):
            if odometry:
                topics.hear(T0 + second * SECOND, "/odom", place)
            found.append(topics.hear(T0 + second * SECOND, "/follow_waypoints/_action/x", message))
        done = DoneTask(T0, T0 + 2 * SECOND, "/follow_waypoints/_action/x", (DoneLeg(6.0, 2 * SECOND / HOUR),),
                        "07" * 4 + "-" + "-".join(["0707"] * 3) + "-" + "07" * 6)  # fmt: skip
        assert found == [None, None, done if odometry else None]
        assert sum(topics.notes.values()) == (not odometry)


@pytest.mark.parametrize(("ros", "state", "outcome"), [
    (1, 2, "cancelled"), (1, 4, "failed"), (1, 8, "cancelled"), (1, 9, "failed"), (2, 5, "cancelled"), (2, 6, "failed"),
])  # fmt: skip
def test_a_goal_that_fails_or_is_cancelled_ends_its_task_by_its_name(ros: int, state: int, outcome: str) -> None:
    """actionlib_msgs/GoalStatus and action_msgs/GoalStatus number the ends of a goal differently."""
    name = Message(id="/nav-7") if ros == 1 else Message(uuid=[1] * 16)
    topics, over = TaskTopics(), Message(goal_info=Message(goal_id=name), goal_id=name, status=state)
    if ros == 1:
        del over.goal_info
    for second, x in enumerate((0.0, 3.0)):
        feedback = Message(current_pose=Message(pose=Message(position=Message(x=x, y=0.0))), distance_remaining=9.0 - x)
        said = Message(
            feedback=feedback, **({"goal_id": name} if ros == 2 else {"status": Message(goal_id=name, status=1)})
        )
        topics.hear(T0 + second * SECOND, "/go/_action/feedback", said)
    ended = topics.hear(T0 + 4 * SECOND, "/go/_action/status", Message(status_list=[over]))
    assert isinstance(ended, DoneTask)
    assert (ended.goal, ended.outcome, ended.legs) == (
        "/nav-7" if ros == 1 else ONE, outcome, (DoneLeg(3.0, 4 * SECOND / HOUR),)
    )  # fmt: skip
    assert topics.notes == {"goal on /go ended without success": 1}


def test_hostile_goals() -> None:
    """Thousands of actions, places that are none, goals that never end: bounded, and counted."""
    topics = TaskTopics()
    for number in range(3000):
        part = Message(
            distance_remaining=math.inf if number % 2 else math.nan,
            current_pose=Message(pose=Message(position=Message(x=math.nan, y=0.0))),
        )
        message = Message("x/action/Y_FeedbackMessage", goal_id=Message(uuid=[number % 256] * 16), feedback=part)
        assert topics.hear(T0, f"/a{number}/_action/feedback", message) is None
        assert topics.hear(T0, "/a0/_action/feedback", message) is None
    assert topics.notes["goal on /a0 without an end"] == 2999
    assert sum(count for what, count in topics.notes.items() if what.startswith("more than 100 actions")) == 2900
