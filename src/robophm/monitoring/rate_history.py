"""The experience with rates that a robot's ledger holds: every life of every part, ended or not."""

from __future__ import annotations

from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.service import service_intervals
from robophm.learning.rates.failure_log import Seen
from robophm.learning.rates.life_scale import Lived


def rate_history(robot: Robot, ledger: Ledger, name: str) -> list[Seen]:
    """Return the experience of each failure mode, as from a log of failures; ``name`` is the robot's in its fleet.

    Raises DataError where rates cannot be learned from it: of a life whose hazard is no power of age, stress that
    scales the hazard leaves a sum into which no other rate can be put.
    """
    found: dict[str, Seen] = {}
    for one in service_intervals(robot, ledger):
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
