"""The experience with rates that a robot's ledger holds: every life of every part, ended or not."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.health.exposure import told_to_now
from robophm.health.ledger import Ledger
from robophm.health.service import service_intervals
from robophm.learning.rates.failure_log import Seen
from robophm.learning.rates.life_scale import Lived


def rate_history(robot: Robot, ledger: Ledger, name: str) -> list[Seen]:
    """Return the experience of each failure mode, as from a log of failures; ``name`` is the robot's in its fleet.

    What software told of failures counts also where it waits in the open window.

    Raises DataError where rates cannot be learned from it: of a life whose hazard is no power of age, stress that
    scales the hazard leaves a sum into which no other rate can be put.
    """
    found: dict[str, Seen] = {}
    for one in service_intervals(robot, told_to_now(robot, ledger)):
        seen = found.setdefault(one.mode.path, Seen(one.mode, name))
        seen.failures += one.failed
        seen.expected += one.parts * one.hazard
        seen.exposure += one.parts * one.hours
        if one.mode.life.degree is None and one.end > one.start and not one.mode.unknown:
            if one.mode.scaling == "hazard":
                kind = type(one.mode.life).__name__.lower()
                raise DataError(
                    f"'{one.mode.path}': of a {kind} life with scaling: hazard a ledger keeps a sum, into which no "
                    "other rate can be put; expected a log, or scaling: age"
                )
            seen.lives.append(Lived(one.start, one.end - one.start, float(one.failed), float(one.parts)))
    return list(found.values())


def each_once(logs: Sequence[str]) -> list[str]:
    """Return a name for each of some stores and logs: its file's, and as many folders as it takes to tell all apart.

    Stores of many robots are often called alike, each in a folder of its own; taken for one robot they would say
    nothing of how much robots differ. Raises DataError for one that is given twice, which would count twice.
    """
    seen: set[Path] = set()
    for log in logs:
        if (path := Path(log).resolve()) in seen:
            raise DataError(f"{log}: is given twice, and would count twice; expected each log once")
        seen.add(path)
    parts = [(*Path(log).absolute().parent.parts, Path(log).stem) for log in logs]
    for folders in range(1, max(map(len, parts), default=1) + 1):
        names = ["/".join(one[-folders:]) for one in parts]
        if len({(name, Path(log).suffix) for name, log in zip(names, logs, strict=True)}) == len(names):
            return names
    return [str(log) for log in logs]
