"""The three topics of the 2020 tool, and paths: tasks out of what is said on them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from robophm.core.errors import SourceError
from robophm.core.literal import numbers, rows
from robophm.core.signal import SECOND
from robophm.transports.tasks.told import DoneLeg, DoneTask, PlannedLeg, PlannedTask

TEXT_TOPICS = ("robot_task_list", "task_time", "task_position", "task_positions")
"""The last steps of the topics whose text tells of tasks."""

SAME_PLACE = 0.25
"""Metres between the ends of two paths that lead to one goal: Nav2's tolerance of a goal, unless it is configured."""

REPLANNED = 60 * SECOND
"""Nanoseconds between two paths to one goal, up to which the later is the same task, planned anew."""

_LIST, _TIME = "robot_task_list", "task_time"


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
        self._paths: dict[str, tuple[int, tuple[float, float]]] = {}
        """The time of the latest path on each topic, and its end."""

    def hear(self, time: int, topic: str, text: str | None) -> PlannedTask | DoneTask | None:
        """Return the task that this text on one of TEXT_TOPICS completes; None is one that came and cannot be read."""
        name = last_step(topic)
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
        """Return the task to follow a path: one leg, since no speed is said by which they would differ.

        Navigation plans anew while it drives: a path to the end of the one before, within REPLANNED, is no new task,
        unless it begins there too and leads round.
        """
        try:
            path = [*places]
            task = PlannedTask(time, topic, (PlannedLeg(finite(sum(_distances(path))), None),))
        except SourceError as error:
            self._refuse(topic, str(error))
            return None
        before = self._paths.get(topic)
        self._paths[topic] = time, path[-1]
        if before and time - before[0] <= REPLANNED and math.dist(before[1], path[-1]) <= SAME_PLACE:
            round_trip = math.dist(before[1], path[0]) <= SAME_PLACE < task.legs[0].distance
            return task if round_trip else None
        return task

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
    return [finite(math.dist(one, other)) for one, other in pairwise(places)]


def finite(distance: float) -> float:
    """Return the distance itself. Raises SourceError where it is not finite."""
    if not math.isfinite(distance):
        raise SourceError(f"a distance of {distance} m; expected a finite one")
    return distance


def last_step(topic: str) -> str:
    """Return the last step of a topic's name."""
    return topic.rpartition("/")[2]
