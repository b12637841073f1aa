"""Dependences that no diagram shows: what depends on what, and what may fail together, in words."""

from __future__ import annotations

from collections.abc import Iterator

from robophm.design.robot import Robot
from robophm.report.outline import Label, names, outline, words

MOST_SAID = 12
"""Notes of one level; the others are counted."""

_BOXES = 20  # of what something depends on; the others are counted


def dependence(robot: Robot, level: str) -> list[str]:
    """A sentence for each dependence and common cause of a level, by its path; "" is the robot."""
    notes = list(_notes(robot, level))
    left = len(notes) - MOST_SAID
    return notes if left <= 1 else [*notes[:MOST_SAID], f"… and {left:,} more"]


def _notes(robot: Robot, level: str) -> Iterator[str]:
    for path, needed in robot.depends_on.items():
        above, _, name = path.rpartition("/")
        if above == level:
            drawn = outline(needed, _BOXES)
            yield f"{name} depends on {words(drawn, {unit: Label(unit) for unit in names(drawn)})}"
    for path, says in robot.groups.items():
        above, _, name = path.rpartition("/")
        if above == level:
            yield f"{name}: {says}"
