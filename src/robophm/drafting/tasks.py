"""Tasks that recordings show: those that they tell of, else all that was driven in each, else how long each lasts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from robophm.core.errors import SourceError
from robophm.core.signal import HOUR
from robophm.drafting.seen import Seen
from robophm.measured.recordings import Recorded
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.tasks import DoneTask, driven_task, tasks_of

MOST = 3
"""Tasks of a draft: the shortest, the middle one and the longest."""

POSITION = ("nav_msgs/Odometry", "px4_msgs/VehicleLocalPosition")
"""Types that tell where a robot is."""

MOST_RECORDINGS = 20
"""The largest number of recordings that are searched for tasks."""


@dataclass(frozen=True)
class SeenTask:
    """A task as it was done."""

    distance: float
    """The distance that was driven [m]; 0 where nothing tells of it."""
    duration: float
    """The time that the task took [h]."""
    told_by: str
    """The recording, and what in it."""

    @property
    def name(self) -> str:
        """The name of the task by its distance and duration: "12.3 m in 45 s"."""
        seconds = self.duration * 3600
        span = f"{seconds:.0f} s" if seconds < 600 else f"{seconds / 60:.0f} min"
        return f"{self.distance:.3g} m in {span}" if self.distance else f"work for {span}"

    def leg(self) -> dict[str, str]:
        """Return the task as a leg of a design or task file."""
        far = {"distance": f"{self.distance:.6g} m"} if self.distance else {}
        return {**far, "duration": f"{self.duration * 3600:.6g} s"}


def tasks_seen(seen: Seen) -> list[SeenTask]:
    """The tasks that recordings show, at most ``MOST``, the shortest first; of several with one name there is one."""
    found = [one for recorded in seen.recorded[:MOST_RECORDINGS] for one in _of(recorded, seen) if one.duration > 0]
    each = list({one.name: one for one in sorted(found, key=lambda one: one.duration)}.values())
    return each if len(each) <= MOST else [each[0], each[len(each) // 2], each[-1]]


def driven(seen: Seen) -> tuple[float, float]:
    """How far the robot drove in its recordings [m], and how long they last [h]; (0, 0) without odometry."""
    metres = hours = 0.0
    for recorded in seen.recorded[:MOST_RECORDINGS]:
        for one in _driven(recorded, seen):
            metres, hours = metres + one.legs[0].distance, hours + one.legs[0].duration
    return metres, hours


def _of(recorded: Recorded, seen: Seen) -> Iterator[SeenTask]:
    file = Path(recorded.name).name
    done: Sequence[DoneTask] = []
    with suppress(SourceError), Recording(*recorded.paths) as recording:  # a table tells of none
        done = [task for task in tasks_of(recording) if isinstance(task, DoneTask)]
    done = done or _driven(recorded, seen)
    for task in done:
        metres, hours = (sum(getattr(leg, key) for leg in task.legs) for key in ("distance", "duration"))
        yield SeenTask(metres, hours, f"{file}, {task.topic}")
    if not done:
        with suppress(SourceError):
            spans = recorded.spans()
            yield SeenTask(0.0, sum(end - begin for begin, end in spans) / HOUR, f"{file}, all of it")


def _driven(recorded: Recorded, seen: Seen) -> list[DoneTask]:
    """All that was driven or flown over ground in a recording, by the first topic of odometry that it has."""
    topics = [one.name for one in seen.of_type(*POSITION) if one.name in recorded.topics]
    if not topics:
        return []
    with suppress(SourceError), open_source(*recorded.paths) as source:
        return [driven_task(source, min(topics, key=len))]
    return []


def tasks_text(tasks: Sequence[SeenTask], functions: Sequence[str], head: str) -> str:
    """A task file with these tasks."""
    lines = [f"# {head}", "schema_version: 1", "tasks:"]
    needed = f", functions: [{', '.join(functions)}]" if functions else ""
    for one in tasks:
        said = ", ".join(f"{key}: {value}" for key, value in one.leg().items())
        lines.append(f"  # as seen in {one.told_by}")
        lines.append(f'  - {{name: "{one.name}", legs: [{{{said}{needed}}}]}}')
    return "\n".join(lines) + "\n"
