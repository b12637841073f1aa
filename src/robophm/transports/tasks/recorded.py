"""The tasks that a recording tells of."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import HOUR, SECOND
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals.source import SignalSource
from robophm.transports.tasks.listener import (
    ACTIONS,
    LONGEST_MESSAGE,
    PATH,
    TEXT,
    TaskTopics,
    tells_of_tasks,
    topics_of,
)
from robophm.transports.tasks.texts import TEXT_TOPICS, finite, last_step
from robophm.transports.tasks.told import DoneLeg, DoneTask, PlannedTask

LONGEST_SILENCE = 60 * SECOND
"""Time [ns] between two poses beyond which what lies between them was not driven: odometers begin anew at a boot."""

_POSITIONS = ("pose.pose.position.", "pose.position.", "position.", "transform.translation.", "point.", "")


def tasks_of(recording: Recording, topics: Collection[str] | None = None) -> Iterator[PlannedTask | DoneTask]:
    """Yield the tasks that these topics tell of, in the order in which they were told.

    A topic may be an action of navigation, ``/navigate_to_pose`` or ``/move_base``. Without topics, all of the 2020
    tool's and of Nav2's and move_base's own names. A nav_msgs/Path is read where it is asked for: navigation publishes
    one at every new plan, not at every task. What cannot be read is in the recording's ``notes``, with the first
    reason.

    Raises SourceError at once where a topic is not in the recording or tells of no tasks.
    """
    types = {info.topic: info.type for info in recording.topics()}
    wanted = {topic for topic in types if last_step(topic) in TEXT_TOPICS}
    strange = {topic for topic in wanted if types[topic] != TEXT}
    wanted |= types.keys() & {*topics_of(ACTIONS)}
    if topics is not None:
        wanted, strange = (
            {each for topic in topics for each in ({*topics_of([topic])} & types.keys() or {topic})},
            set(),
        )
    for topic in sorted(wanted & types.keys() - strange):
        if not tells_of_tasks(topic, types[topic]):
            raise SourceError(
                f"topic '{topic}' ({types[topic] or 'of unknown type'}) tells of no tasks; expected {PATH}, an action "
                f"of navigation, or {TEXT} on a topic whose last step is {', '.join(TEXT_TOPICS)}"
            )
    messages = recording.messages(wanted - strange, LONGEST_MESSAGE)
    for topic in strange:
        recording.notes[f"{topic} is left out: {types[topic] or 'of unknown type'}; expected {TEXT}"] += 1
    return tasks_in(messages, TaskTopics(recording.notes))


def told_by(recording: Recording, topics: Sequence[str] = ()) -> tuple[list[PlannedTask | DoneTask], Counter[str]]:
    """Return all tasks that a recording tells of, by the time at which each came or ended, and what is unreadable.

    ``topics`` may tell of tasks, as those of ``tasks_of``, or say where the robot was: all that it drove is then one
    task (``driven_task``). Raises SourceError as these do, and where there is no task.
    """
    types = {info.topic: info.type for info in recording.topics()}
    places = [topic for topic in topics if _says_where(topic, types)]
    listened = [topic for topic in topics if topic not in places]
    told = list(tasks_of(recording, listened or None)) if listened or not topics else []
    unread = recording.notes.copy()
    told += [driven_task(recording, topic) for topic in places]
    if not told and unread:
        raise SourceError(f"the recording tells of no task that can be read: {min(unread)}")
    if not told:
        raise SourceError(
            f"the recording tells of no task; expected topics named {', '.join(TEXT_TOPICS)}, or another topic "
            "with a path or with where the robot was"
        )
    return sorted(told, key=lambda one: one.time if isinstance(one, PlannedTask) else one.end), unread


def _says_where(topic: str, types: Mapping[str, str]) -> bool:
    """Whether a topic is asked what was driven, and not for what is told of tasks."""
    meant = [each for each in topics_of([topic]) if each in types]
    return types.get(topic) not in (TEXT, PATH) and not any(tells_of_tasks(each, types[each]) for each in meant)


def tasks_in(messages: Iterable[tuple[int, str, Any]], topics: TaskTopics) -> Iterator[PlannedTask | DoneTask]:
    """Yield the tasks that these messages tell of, planned or done; of others that ended it is noted that they did.

    None in place of a message is one that cannot be read.
    """
    for time, topic, message in messages:
        task = topics.hear(time, topic, message)
        if task and (isinstance(task, PlannedTask) or task.outcome == "succeeded"):
            yield task
    topics.texts.end()


def driven_task(source: SignalSource, topic: str, start: int | None = None, end: int | None = None) -> DoneTask:
    """Return all that the robot drove from ``start`` to ``end`` [ns since the epoch] as one task of one leg.

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
    return DoneTask(first, latest, topic, (DoneLeg(finite(distance), (latest - first) / HOUR),))


def _poses(source: SignalSource, x: str, y: str) -> Iterator[tuple[int, float, float]]:
    """Time, x and y of every message that has both."""
    when, latest_x = None, 0.0
    for time, signal, value in source.samples([x, y]):
        if signal == x:
            when, latest_x = time, value
        elif signal == y and time == when:
            yield time, latest_x, value
