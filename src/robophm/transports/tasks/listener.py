"""Topics that tell of tasks, whatever their type."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable
from typing import Any

from robophm.core.literal import LONGEST_LITERAL
from robophm.transports.tasks.goals import GoalListener
from robophm.transports.tasks.orders import OrderListener, tells_of_order
from robophm.transports.tasks.texts import TEXT_TOPICS, TaskListener, last_step
from robophm.transports.tasks.told import DoneTask, PlannedTask

LONGEST_MESSAGE = 16 * LONGEST_LITERAL
"""Bytes of a message beyond which it is not decoded."""

NOT_AS_EXPECTED = (AttributeError, TypeError, ValueError, ArithmeticError, LookupError, RecursionError)
"""Errors that come of a message whose fields are missing, of other types, or numbers too large for what they are."""

TEXT, PATH, ODOMETRY = "std_msgs/msg/String", "nav_msgs/msg/Path", "nav_msgs/msg/Odometry"

ACTIONS = ("/navigate_to_pose", "/navigate_through_poses", "/follow_waypoints", "/move_base")
"""Actions whose goals are listened to unless it is said otherwise."""

_TYPES_OF_ACTIONS = ("_FeedbackMessage", "/GoalStatusArray", "ActionFeedback", "ActionGoal", "ActionResult")
_OF_ACTION = ("_action/feedback", "_action/status", "goal", "feedback", "status", "result")


class TaskTopics:
    """Hears messages as they come and says which task each completes; what it cannot read is counted in ``notes``."""

    def __init__(self, notes: Counter[str] | None = None) -> None:
        self.notes = Counter() if notes is None else notes
        self.texts = TaskListener(self.notes)
        self._goals = GoalListener(self.notes)
        self._orders = OrderListener(self.notes)

    def hear(self, time: int, topic: str, message: Any) -> PlannedTask | DoneTask | None:
        """Return the task that this message, received at ``time`` [ns], completes; None came and is unreadable."""
        try:
            return self._hear(time, topic, message)
        except NOT_AS_EXPECTED:  # JSON may have anything anywhere
            said = "no order and no state of one; expected VDA 5050" if tells_of_order(message) else (
                "no goal and no state of one; expected those of an action")  # fmt: skip
            self.notes[f"{topic}: {said}"] += 1
            return None

    def _hear(self, time: int, topic: str, message: Any) -> PlannedTask | DoneTask | None:
        type_ = getattr(message, "__msgtype__", None)
        if type_ == PATH:
            places = ((pose.pose.position.x, pose.pose.position.y) for pose in message.poses)
            return self.texts.hear_path(time, topic, places)
        if type_ == TEXT and last_step(topic) in TEXT_TOPICS:
            return self.texts.hear(time, topic, message.data)
        if type_ == ODOMETRY:
            position = message.pose.pose.position
            self._goals.drive((position.x, position.y))
            return None
        if tells_of_order(message):
            return self._orders.hear(time, topic, message)
        if any(hasattr(message, name) for name in ("feedback", "status_list", "result", "goal")):
            return self._goals.hear(time, topic, message)
        if type_ is not None:
            self.notes[f"message of type {type_} on {topic}"] += 1
        if last_step(topic) in TEXT_TOPICS:
            return self.texts.hear(time, topic, None)
        return None


def tells_of_tasks(topic: str, type_: str) -> bool:
    """Whether messages of this type on this topic tell of tasks."""
    if type_ == TEXT:
        return last_step(topic) in TEXT_TOPICS
    return type_ == PATH or type_.endswith(_TYPES_OF_ACTIONS)


def known_topics(*roots: str) -> list[str]:
    """Return the topics that tell of tasks by their names, at each root: the 2020 tool's, and those of ACTIONS."""
    texts = [f"{root}/{name}" for root in roots for name in TEXT_TOPICS]
    return texts + topics_of(f"{root}{name}" for root in roots for name in ACTIONS)


def topics_to_hear(named: Collection[str] = (), namespace: str = "", own: Collection[str] = ()) -> list[str]:
    """Return the topics and actions to listen to for tasks as they are named; where none is, those known by name.

    Of these both the ones in a robot's ``namespace`` and the ones outside it, and the source's ``own``.
    """
    return topics_of(named) if named else [*known_topics(*dict.fromkeys(("", namespace.rstrip("/")))), *own]


def topics_of(named: Iterable[str]) -> list[str]:
    """Return all topics that may be meant: those named so, and those of actions of that name."""
    return [topic for name in named for topic in (name, *(f"{name}/{part}" for part in _OF_ACTION))]
