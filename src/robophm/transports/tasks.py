"""What robots say of their tasks: what is planned, and what was done.

Read are the three topics of the 2020 tool, std_msgs/String with a list in it, found by the last step of their name:

    robot_task_list               [[x, y, speed], …]   m, m/s: a task that is planned
    task_time                     [t, …]               s: the times of the legs of a task that is done
    task_position, task_positions [[x, y], …]          m: where it led, one place more than there are times

nav_msgs/Path, a planned task, and the poses of a robot, one done task. Distances are in the plane, as are those of
the kilometres clock.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

from robophm.core.errors import SourceError, nearest
from robophm.core.literal import LONGEST_LITERAL, numbers, rows
from robophm.core.signal import HOUR, SECOND
from robophm.transports.recording import Recording
from robophm.transports.source import SignalSource

TEXT_TOPICS = ("robot_task_list", "task_time", "task_position", "task_positions")
"""The last steps of the topics whose text tells of tasks."""

LONGEST_MESSAGE = 16 * LONGEST_LITERAL
"""Bytes of a message beyond which it is not decoded."""

LONGEST_SILENCE = 60 * SECOND
"""Time [ns] between two poses beyond which what lies between them was not driven: odometers begin anew at a boot."""

_TEXT, _PATH = "std_msgs/msg/String", "nav_msgs/msg/Path"
_LIST, _TIME = "robot_task_list", "task_time"
_POSITIONS = ("pose.pose.position.", "pose.position.", "position.", "transform.translation.", "point.", "")


class PlannedLeg(NamedTuple):
    """A straight way, or a whole path, that is to be driven."""

    distance: float
    """[m]"""
    speed: float | None
    """[m/s], None where the robot did not say."""


class DoneLeg(NamedTuple):
    """A way that was driven."""

    distance: float
    """[m]"""
    duration: float
    """[h]"""


@dataclass(frozen=True)
class PlannedTask:
    """A task that arrived; ``time`` [ns since the epoch] is when."""

    time: int
    topic: str
    legs: tuple[PlannedLeg, ...]


@dataclass(frozen=True)
class DoneTask:
    """A task that was done from ``start`` to ``end`` [ns since the epoch]."""

    start: int
    end: int
    topic: str
    legs: tuple[DoneLeg, ...]


def tasks_of(recording: Recording, topics: Collection[str] | None = None) -> Iterator[PlannedTask | DoneTask]:
    """The tasks that these topics tell of, in the order in which they were told.

    Without topics, all of the 2020 tool's. A nav_msgs/Path is read where it is asked for: navigation publishes one
    at every new plan, not at every task. What cannot be read is in the recording's ``notes``, with the first reason.

    Raises SourceError at once where a topic is not in the recording or tells of no tasks.
    """
    types = {info.topic: info.type for info in recording.topics()}
    wanted = {topic for topic in types if _last_step(topic) in TEXT_TOPICS}
    strange = {topic for topic in wanted if types[topic] != _TEXT}
    if topics is not None:
        wanted, strange = {*topics}, set()
    for topic in sorted(wanted & types.keys() - strange):
        if types[topic] != _PATH and (types[topic] != _TEXT or _last_step(topic) not in TEXT_TOPICS):
            raise SourceError(
                f"topic '{topic}' ({types[topic] or 'of unknown type'}) tells of no tasks; expected {_PATH}, or "
                f"{_TEXT} on a topic whose last step is {', '.join(TEXT_TOPICS)}"
            )
    messages = recording.messages(wanted - strange, LONGEST_MESSAGE)
    for topic in strange:
        recording.notes[f"{topic} is left out: {types[topic] or 'of unknown type'}; expected {_TEXT}"] += 1
    return _tasks(messages, TaskListener(recording.notes))


def _tasks(messages: Iterable[tuple[int, str, Any]], listener: TaskListener) -> Iterator[PlannedTask | DoneTask]:
    for time, topic, message in messages:
        type_ = getattr(message, "__msgtype__", None)
        task: PlannedTask | DoneTask | None = None
        if type_ == _PATH:
            places = ((pose.pose.position.x, pose.pose.position.y) for pose in message.poses)
            task = listener.hear_path(time, topic, places)
        elif type_ == _TEXT:
            task = listener.hear(time, topic, message.data)
        elif _last_step(topic) in TEXT_TOPICS:
            task = listener.hear(time, topic, None)
        if type_ not in (_PATH, _TEXT, None):
            listener.notes[f"message of type {type_} on {topic}"] += 1
        if task:
            yield task
    listener.end()


class TaskListener:
    """Hears the messages about tasks, live or recorded, and says which task each of them completes.

    A task is done when its times and its places have been heard, one after the other on topics of one namespace and
    in either order; it ended when the later came and began as long before as its times say. A message that does not
    fit is counted in ``notes`` and told of nowhere else.
    """

    def __init__(self, notes: Counter[str] | None = None) -> None:
        self.notes = Counter() if notes is None else notes
        self._waiting: dict[str, _Half] = {}
        self._reasons: dict[str, str] = {}

    def hear(self, time: int, topic: str, text: str | None) -> PlannedTask | DoneTask | None:
        """The task that this text on one of TEXT_TOPICS completes; None is one that came and cannot be read."""
        name = _last_step(topic)
        half = _Half(time, topic, name == _TIME)
        try:
            if text is None:
                pass
            elif name == _LIST:
                return PlannedTask(time, topic, _planned_legs(rows(text)))
            elif name == _TIME:
                half.times = _times(numbers(text))
            else:
                half.places = [_place(row, number, "[x, y]") for number, row in enumerate(rows(text), 1)]
        except SourceError as error:
            self._refuse(topic, str(error))
        return None if name == _LIST else self._pair(half)

    def hear_path(self, time: int, topic: str, places: Iterable[tuple[float, float]]) -> PlannedTask | None:
        """The task to follow a path: one leg, since no speed is said by which they would differ."""
        try:
            return PlannedTask(time, topic, (PlannedLeg(_finite(sum(_distances([*places]))), None),))
        except SourceError as error:
            self._refuse(topic, str(error))
            return None

    def end(self) -> None:
        """Count what still waits for its other half."""
        for half in self._waiting.values():
            self._alone(half)
        self._waiting.clear()

    def _pair(self, half: _Half) -> DoneTask | None:
        robot = half.topic.rpartition("/")[0]
        other = self._waiting.pop(robot, None)
        if other is None or not half.completes(other):
            self._alone(other)
            self._waiting[robot] = half
            return None
        times, places = (half, other) if half.is_times else (other, half)
        if times.times is None or places.places is None:  # unreadable, and so is the task
            self._alone(times)
            self._alone(places)
            return None
        try:
            return DoneTask(*_span(half.time, times.times), times.topic, _done_legs(times.times, places.places))
        except SourceError as error:
            self._refuse(times.topic, str(error))
            return None

    def _alone(self, half: _Half | None) -> None:
        if half and (half.times is not None or half.places is not None):  # the unreadable was counted when it came
            self.notes[f"{half.topic} without its other half"] += 1

    def _refuse(self, topic: str, reason: str) -> None:
        """Count it under the topic's first reason: one reason for each message would have no bound."""
        first = self._reasons.setdefault(topic, reason)
        self.notes[f"no task in a message on {topic} (the first: {first})"] += 1


@dataclass
class _Half:
    """The times [s] or the places [m] of a task; neither where they could not be read."""

    time: int
    topic: str
    is_times: bool
    times: list[float] | None = None
    places: list[tuple[float, float]] | None = None

    def completes(self, earlier: _Half) -> bool:
        """Whether both are of one task: they come when it is done, and neither before it began."""
        if self.is_times == earlier.is_times:
            return False
        times = self.times if self.is_times else earlier.times
        return times is None or self.time - earlier.time <= sum(times) * SECOND


def driven_task(source: SignalSource, topic: str, start: int | None = None, end: int | None = None) -> DoneTask:
    """All that the robot drove from ``start`` to ``end`` [ns since the epoch] as one task of one leg.

    The topic says where the robot is: nav_msgs/Odometry, geometry_msgs/PoseStamped, turtlesim/Pose, any type with x
    and y in such a place. The task begins and ends with the first and the last pose of that time; its distance is the
    path from pose to pose. Poses that are not finite or come late, and steps across LONGEST_SILENCE, are left out and
    counted in ``source.notes``.

    Raises SourceError where the topic has no position, or fewer than two poses are left.
    """
    known = {info.topic: info for info in source.topics()}
    if topic not in known:
        raise SourceError(f"no topic '{topic}'{nearest(topic, known)}")
    fields = set(known[topic].fields)
    prefix = next((prefix for prefix in _POSITIONS if {prefix + "x", prefix + "y"} <= fields), None)
    if prefix is None:
        raise SourceError(
            f"topic '{topic}' ({known[topic].type or 'of unknown type'}) does not say where the robot is; "
            f"expected x and y, as in nav_msgs/msg/Odometry"
        )
    first = latest = before = None
    poses, distance = 0, 0.0
    for time, *place in _poses(source, f"{topic}.{prefix}x", f"{topic}.{prefix}y"):
        if (start is not None and time < start) or (end is not None and time > end):
            continue
        if not all(map(math.isfinite, place)):
            source.notes[f"position on {topic} is not finite"] += 1
            continue
        if latest is not None and time < latest:
            source.notes[f"late pose on {topic}"] += 1
            continue
        if before is None or latest is None:
            first = time
        elif time - latest > LONGEST_SILENCE:
            source.notes[f"no pose for more than {LONGEST_SILENCE // SECOND} s on {topic}"] += 1
        else:
            distance += math.dist(before, place)
        poses, latest, before = poses + 1, time, place
    if first is None or latest is None or first == latest:
        raise SourceError(f"topic '{topic}' has {poses} poses in that time; expected at least two, one after the other")
    return DoneTask(first, latest, topic, (DoneLeg(_finite(distance), (latest - first) / HOUR),))


def _poses(source: SignalSource, x: str, y: str) -> Iterator[tuple[int, float, float]]:
    """Time, x and y of every message that has both."""
    when, latest_x = None, 0.0
    for time, signal, value in source.samples([x, y]):
        if signal == x:
            when, latest_x = time, value
        elif signal == y and time == when:
            yield time, latest_x, value


def _planned_legs(waypoints: Sequence[Sequence[float]]) -> tuple[PlannedLeg, ...]:
    """A leg from each waypoint to the next, at the speed that is given where it begins."""
    places = [_place(waypoint, number, "[x, y, speed]") for number, waypoint in enumerate(waypoints, 1)]
    legs = tuple(map(PlannedLeg, _distances(places), (waypoint[2] for waypoint in waypoints)))
    for number, (distance, speed) in enumerate(legs, 1):
        if speed is None or speed <= 0 or not math.isfinite(distance / speed):
            raise SourceError(f"leg {number} of {distance:g} m has a speed of {speed:g} m/s; expected one above zero")
    return legs


def _done_legs(times: Sequence[float], places: Sequence[tuple[float, float]]) -> tuple[DoneLeg, ...]:
    distances = _distances(places)
    if len(times) != len(distances):
        raise SourceError(f"{len(times)} times with {len(places)} positions; expected {len(places) - 1}")
    for number, (distance, time) in enumerate(zip(distances, times, strict=True), 1):
        if time == 0 and distance:
            raise SourceError(f"leg {number} of {distance:g} m took 0 s; expected a time above zero")
    return tuple(DoneLeg(distance, time / 3600) for distance, time in zip(distances, times, strict=True))


def _span(end: int, times: Sequence[float]) -> tuple[int, int]:
    """Start and end of a task [ns] that took these times [s]."""
    took = sum(times)
    if took * SECOND > end:
        raise SourceError(f"took {took:g} s; expected no more than have passed since the epoch")
    return end - round(took * SECOND), end


def _times(times: list[float]) -> list[float]:
    for number, time in enumerate(times, 1):
        if time < 0:
            raise SourceError(f"leg {number} took {time:g} s; expected no negative time")
    return times


def _place(row: Sequence[float], number: int, form: str) -> tuple[float, float]:
    if len(row) != len(form.split(",")):
        raise SourceError(f"position {number} has {len(row)} numbers; expected {form}")
    return row[0], row[1]


def _distances(places: Sequence[tuple[float, float]]) -> list[float]:
    """The straight way from each place to the next [m]."""
    if len(places) < 2:
        raise SourceError(f"{len(places)} positions; expected at least 2")
    return [_finite(math.dist(one, other)) for one, other in pairwise(places)]


def _finite(distance: float) -> float:
    if not math.isfinite(distance):
        raise SourceError(f"a distance of {distance} m; expected a finite one")
    return distance


def _last_step(topic: str) -> str:
    return topic.rpartition("/")[2]
