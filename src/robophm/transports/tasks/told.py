"""Tasks as robots tell of them: one that is planned, one that is done."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

Outcome = Literal["succeeded", "failed", "cancelled"]
"""The end of a goal: reached, given up by the robot, or called off by whoever set it."""


class PlannedLeg(NamedTuple):
    """A straight way, or a whole path, that is to be driven."""

    distance: float
    """Distance of the leg [m]."""
    speed: float | None
    """Speed of the leg [m/s]; None where the robot did not say."""


class DoneLeg(NamedTuple):
    """A leg that was driven."""

    distance: float
    """Distance of the leg [m]."""
    duration: float
    """Duration of the leg [h]."""


@dataclass(frozen=True)
class PlannedTask:
    """A task that arrived; ``time`` [ns since the epoch] is when."""

    time: int
    topic: str
    legs: tuple[PlannedLeg, ...]
    goal: str = ""
    """Name by which the robot knows its goal; empty where it told none."""


@dataclass(frozen=True)
class DoneTask:
    """A task that was done, or given up, from ``start`` to ``end`` [ns since the epoch]."""

    start: int
    end: int
    topic: str
    legs: tuple[DoneLeg, ...]
    goal: str = ""
    outcome: Outcome = "succeeded"
