"""Sources of samples: recordings named at the start, the synthetic robot, live ROS of either generation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from robophm.core.errors import SourceError, nearest
from robophm.transports.recordings.files import holds_messages
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.paced import Paced
from robophm.transports.recordings.salvage import Salvage
from robophm.transports.signals.source import SignalSource
from robophm.transports.tasks import DoneTask, PlannedTask, tasks_of

Told = Sequence[PlannedTask | DoneTask]


@dataclass(frozen=True)
class Choice:
    """A source that a person can choose."""

    name: str
    label: str
    open: Callable[[float], SignalSource]
    """Function that opens the source, at a multiple of its own speed."""
    tasks: Callable[[], Told]
    """Function that returns what it tells of tasks, where that can be known beforehand."""
    paced: bool
    """Whether its speed can be chosen."""


def choices(recordings: Iterable[Path], *, seed: int | None = None, live: bool = True) -> dict[str, Choice]:
    """Return sources by name: "recordings" where there are any, "synthetic" with a seed, "ros1" and "ros2"."""
    found = []
    if files := [*recordings]:
        label = files[0].name if len(files) == 1 else f"{len(files)} recordings"
        found.append(
            Choice("recordings", label, lambda speed: Paced(open_source(*files), speed), lambda: _told(files), True)
        )
    if seed is not None:
        found.append(Choice("synthetic", "synthetic OTA", lambda speed: _synthetic(seed, speed),
                            lambda: _synthetic_tasks(seed), True))  # fmt: skip
    if live:
        found.append(Choice("ros1", "ROS 1 (ROS_MASTER_URI)", lambda speed: _live("ros1"), lambda: (), False))
        found.append(Choice("ros2", "ROS 2 (ROS_DOMAIN_ID)", lambda speed: _live("ros2"), lambda: (), False))
    return {one.name: one for one in found}


def begins(task: PlannedTask | DoneTask) -> int:
    """Return when a recording first tells of a task [ns]."""
    return task.time if isinstance(task, PlannedTask) else task.start


def chosen(known: dict[str, Choice], name: str) -> Choice:
    """Return the source of that name. Raises SourceError."""
    if name not in known:
        raise SourceError(f"no source '{name}'{nearest(name, known)}")
    return known[name]


def _told(files: Sequence[Path]) -> Told:
    if not all(path.is_dir() or holds_messages(path) for path in files):
        return ()
    with Salvage(*files) as recording:
        return list(tasks_of(recording))


def _synthetic(seed: int, speed: float) -> SignalSource:
    from robophm.transports.synthetic import SyntheticOta

    return Paced(SyntheticOta(seed=seed), speed)


def _synthetic_tasks(seed: int) -> Told:
    from robophm.transports.synthetic import SyntheticOta

    return SyntheticOta(seed=seed).tasks()


def _live(via: str) -> SignalSource:
    from robophm.transports.running_robot import open_live

    return open_live(via).source
