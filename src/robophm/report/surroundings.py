"""Sentences on the environments and qualities that the parts of a design are rated for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from robophm.design.robot import Robot
from robophm.hazard.environments import ENVIRONMENTS, explained


def environments(robot: Robot) -> Counter[str]:
    """How many parts are rated for which environment, by its symbol; parts whose rate asks for none are in none."""
    found: Counter[str] = Counter()
    for part in robot.all_components():
        stated = {stress.design.get("environment") for mode in part.modes for stress in mode.stresses}
        for symbol in ENVIRONMENTS:
            if symbol in stated:
                found[symbol] += part.quantity
    return found


def qualities(robot: Robot) -> Counter[str]:
    """How many parts are rated for which quality level of their models."""
    found: Counter[str] = Counter()
    for part in robot.all_components():
        stated = {
            str(stress.design["quality"])
            for mode in part.modes
            for stress in mode.stresses
            if "quality" in stress.design
        }
        found.update(dict.fromkeys(stated, part.quantity))
    return found


def qualities_in_words(robot: Robot) -> Iterator[str]:
    """One line of all levels, and where they are explained; none where no part has one."""
    if found := qualities(robot):
        said = ", ".join(f"{level} ({parts})" for level, parts in found.most_common())
        yield f"quality levels of parts: {said}; for a whole board quality: … says it once (robophm models quality)"


def environments_in_words(robot: Robot) -> Iterator[str]:
    """One line for each environment: "environment GM (Ground, Mobile: …), of 12 parts"."""
    found = environments(robot)
    for symbol in ENVIRONMENTS:
        parts = found[symbol]
        if parts:
            yield f"environment {explained(symbol)}, of {parts} part{'s' * (parts != 1)}"
