"""Goals of navigation: what Nav2 and move_base say while they drive, and when they are there.

Nav2 (ROS 2): ``<action>/_action/feedback`` of NavigateToPose, NavigateThroughPoses, FollowWaypoints, FollowPath, and
``<action>/_action/status`` (action_msgs/GoalStatusArray). move_base (ROS 1): ``<action>/goal``, ``feedback``,
``status``, ``result`` (actionlib). A goal is planned when its feedback first says how far it is; it is done when its
status says that it succeeded, and has ended as well where that says otherwise. Fields are found by name, since later
versions append some.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from robophm.core.signal import HOUR, SECOND
from robophm.transports.tasks.told import DoneLeg, DoneTask, Outcome, PlannedLeg, PlannedTask

ENDS: dict[int, dict[int, Outcome]] = {
    1: {3: "succeeded", 2: "cancelled", 8: "cancelled", 4: "failed", 5: "failed", 9: "failed"},
    2: {4: "succeeded", 5: "cancelled", 6: "failed"},
}
"""States in which a goal has ended, by generation of ROS and number (actionlib_msgs/GoalStatus: preempted, recalled;
aborted, rejected, lost; action_msgs/GoalStatus: canceled; aborted)."""

MOST_ACTIONS = 100
"""Actions that are followed; messages of further ones are counted."""

Place = tuple[float, float]


@dataclass
class _Goal:
    """A goal that is under way."""

    name: bytes | str
    start: int
    target: Place | None = None
    planned: bool = False
    place: Place | None = None
    driven: float | None = None
    """Distance driven by the poses in its feedback [m]."""
    odometer: float | None = None
    """Odometer when the goal began [m]."""


class GoalListener:
    """Hears what actions of navigation say, live or recorded, and which task it makes; what does not is in ``notes``.

    The distance of a done task is by odometry where ``drive`` tells it, else by the poses in the feedback.
    """

    def __init__(self, notes: Counter[str]) -> None:
        self.notes = notes
        self._goals: dict[str, _Goal] = {}
        self._ended: dict[str, bytes | str] = {}
        self._targets: dict[str, tuple[bytes | str, Place]] = {}
        self._place: Place | None = None
        self._odometer: float | None = None

    def drive(self, place: Place) -> None:
        """Take the robot's position by its odometry [m]."""
        if all(map(math.isfinite, place)):
            self._odometer = (self._odometer or 0.0) + (math.dist(self._place, place) if self._place else 0.0)
            self._place = place

    def hear(self, time: int, topic: str, message: Any) -> PlannedTask | DoneTask | None:
        """Return the task that this message plans or completes."""
        action = topic.rpartition("/_action/")[0] or topic.rpartition("/")[0]
        if action not in self._goals and len(self._goals) >= MOST_ACTIONS:
            self.notes[f"more than {MOST_ACTIONS} actions: {topic}"] += 1
            return None
        if hasattr(message, "feedback"):
            return self._under_way(time, topic, action, message)
        if hasattr(message, "status_list"):
            found = [self._ends(time, topic, action, *_status(one)) for one in message.status_list]
            return next(filter(None, found), None)
        if hasattr(message, "result") and hasattr(message, "status"):
            return self._ends(time, topic, action, *_status(message.status))
        if hasattr(message, "goal") and (target := _place_in(message.goal, "target_pose")):
            self._targets[action] = message.goal_id.id, target
        return None

    def _under_way(self, time: int, topic: str, action: str, message: Any) -> PlannedTask | None:
        name = _name(message.goal_id) if hasattr(message, "goal_id") else _status(message.status)[0]
        if self._ended.get(action) == name:  # what was still on the way
            return None
        goal = self._goals.get(action)
        feedback = message.feedback
        if goal is None or goal.name != name:
            if goal:
                self.notes[f"goal on {action} without an end"] += 1
            took = max(0, _nanoseconds(getattr(feedback, "navigation_time", None)))
            goal = self._goals[action] = _Goal(name, time - min(took, time), odometer=self._odometer)
            known, target = self._targets.get(action, (None, None))
            goal.target = target if known == name else None
        place = _place_in(feedback, "current_pose") or _place_in(feedback, "base_position")
        if place:
            goal.driven = (goal.driven or 0.0) + (math.dist(goal.place, place) if goal.place else 0.0)
            goal.place = place
        if goal.planned:
            return None
        distance = getattr(feedback, "distance_remaining", getattr(feedback, "distance_to_goal", None))
        if distance is None and goal.target and goal.place:
            distance = math.dist(goal.target, goal.place)
        if distance is None or not (math.isfinite(distance) and distance > 0):
            return None
        goal.planned = True
        seconds = _nanoseconds(getattr(feedback, "estimated_time_remaining", None)) / SECOND
        return PlannedTask(
            time, topic, (PlannedLeg(float(distance), distance / seconds if seconds > 0 else None),), _text(name)
        )

    def _ends(self, time: int, topic: str, action: str, name: bytes | str, state: int, ros: int) -> DoneTask | None:
        goal = self._goals.get(action)
        outcome = ENDS[ros].get(state)
        if goal is None or goal.name != name or outcome is None:
            return None
        del self._goals[action]
        self._ended[action] = name
        if outcome != "succeeded":
            self.notes[f"goal on {action} ended without success"] += 1
        driven = goal.driven
        if self._odometer is not None and goal.odometer is not None:
            driven = self._odometer - goal.odometer
        if driven is None:
            self.notes[
                f"goal on {action} {outcome}, nothing says how far it was; expected odometry among the topics"
            ] += 1
            return None
        leg = DoneLeg(driven, (time - goal.start) / HOUR)
        return DoneTask(goal.start, time, topic, (leg,), _text(name), outcome)


def _name(goal_id: Any) -> bytes | str:
    return bytes(goal_id.uuid) if hasattr(goal_id, "uuid") else str(goal_id.id)


def _text(name: bytes | str) -> str:
    """The name of a goal as ROS's tools show it."""
    return name if isinstance(name, str) else str(UUID(bytes=name)) if len(name) == 16 else name.hex()


def _status(one: Any) -> tuple[bytes | str, int, int]:
    """Name of the goal, its state, and the generation of ROS whose numbers that has."""
    if hasattr(one, "goal_info"):
        return _name(one.goal_info.goal_id), int(one.status), 2
    return _name(one.goal_id), int(one.status), 1


def _place_in(part: Any, name: str) -> Place | None:
    """The position in a PoseStamped, where it is finite."""
    position = getattr(getattr(getattr(part, name, None), "pose", None), "position", None)
    if position is None or not (math.isfinite(position.x) and math.isfinite(position.y)):
        return None
    return position.x, position.y


def _nanoseconds(duration: Any) -> int:
    return int(duration.sec) * SECOND + int(duration.nanosec) if duration is not None else 0
