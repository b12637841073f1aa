"""Robots of a fleet by what they recorded: each is replayed into a store of its own, several at once."""

from __future__ import annotations

import signal
from collections.abc import Generator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

from robophm.core.child_process import end_with_parent
from robophm.core.errors import RobophmError, nearest
from robophm.design.file import load
from robophm.monitoring.recording_sessions import sessions_of
from robophm.monitoring.replay import replay_sessions
from robophm.stores import open_store

DESIGNS = (".yaml", ".yml")
"""Endings of the names of designs."""


class RecordedRobot(NamedTuple):
    """A robot, its design, and what it recorded."""

    name: str
    design: Path
    recordings: tuple[Path, ...]


class Replayed(NamedTuple):
    """The health of a robot after all that it recorded, or why there is none."""

    robot: str
    health: Mapping[str, Any] | None
    """The health report as JSON; None where there is none."""
    error: str


def recorded_robots(designs: Path, recordings: Path) -> list[RecordedRobot]:
    """Return the robots whose recordings lie in a folder, in the order of their names.

    ``designs``: one design that all of them have, or a folder of designs, each named as its robot. What lies in
    ``recordings`` under the name of a design, or is a folder of recordings, is a robot's. Raises RobophmError where
    it is not known whose a recording is, or what design a robot has.
    """
    if not recordings.is_dir():
        raise RobophmError(f"{recordings}: expected a folder with a folder of recordings for each robot")
    one = None if designs.is_dir() else designs
    own = {} if one else {path.stem: path for path in sorted(designs.iterdir()) if path.suffix.lower() in DESIGNS}
    found: dict[str, RecordedRobot] = {}
    for entry in _shown(recordings):
        is_bag = entry.is_file() or (entry / "metadata.yaml").exists()  # of ROS 2, a folder that is one recording
        name = entry.stem if entry.is_file() else entry.name
        if one and is_bag:
            raise RobophmError(f"{entry}: whose recording it is is not known; expected it in a folder named as the "
                               "robot, or a folder of designs with one of its name")  # fmt: skip
        if name in found:
            raise RobophmError(f"{entry}: {found[name].recordings[0]} is of {name!r} too; expected both in one folder")
        design = one or own.get(name)
        if design is None:
            raise RobophmError(f"{entry}: there is no {name}.yaml in {designs}{nearest(name, own)}")
        found[name] = RecordedRobot(name, design, (entry,) if is_bag else _shown(entry))
    if not found:
        raise RobophmError(f"{recordings}: is empty; expected a folder of recordings for each robot")
    return [*found.values()]


def _shown(folder: Path) -> tuple[Path, ...]:
    return tuple(path for path in sorted(folder.iterdir()) if not path.name.startswith("."))


def replayed(
    robots: list[RecordedRobot], stores: Path, jobs: int, *, skip_missing: bool = False
) -> Generator[Replayed]:
    """Yield the health of robots as they are done, each kept in NAME.db of a folder, so many replayed at once.

    A recording that is in a robot's store already is not counted again, so what was ended at any moment goes on from
    there when it is asked for once more. The processes end with this one, however it ends. Raises RobophmError where
    one of them was killed.
    """
    stores.mkdir(parents=True, exist_ok=True)
    pool = ProcessPoolExecutor(min(jobs, len(robots)), get_context("spawn"), initializer=_begin)
    try:
        asked = [pool.submit(_one, one, stores / f"{one.name}.db", skip_missing) for one in robots]
        for done in as_completed(asked):
            yield done.result()
    except BrokenProcessPool:
        raise RobophmError(
            "a process was killed, or had no memory left; what it had kept stays, and a further replay goes on from "
            "there; expected fewer processes at once where memory is short"
        ) from None
    finally:
        pool.shutdown(cancel_futures=True)


def _begin() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    end_with_parent()


def _one(one: RecordedRobot, store: Path, skip_missing: bool) -> Replayed:
    try:
        robot = load(one.design)
        sessions = sessions_of(robot, one.recordings, skip_missing=skip_missing)  # before a store is made for them
        with open_store(store) as kept:
            health = replay_sessions(robot, sessions, store=kept)
    except RobophmError as error:
        return Replayed(one.name, None, str(error))
    return Replayed(one.name, health.to_json(), "")
