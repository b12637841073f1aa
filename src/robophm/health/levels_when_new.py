"""The levels of a new robot, and which of them are as they were in the robot before an edit.

What a level promises when new follows from its diagram, its parts and how the robot is used. Where these are the same,
so is the promise: of a large design that is edited in one place, one level and those around it are worked out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from operator import is_

from robophm.blocks.diagram import Block, units
from robophm.design.robot import Component, Usage
from robophm.health.prepared_diagram import PreparedDiagram
from robophm.health.prognosis import Outlook
from robophm.health.subject import figures_now
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown


@dataclass(frozen=True)
class LevelWhenNew:
    """A level of a new robot: its hazard rate, and all that this follows from."""

    prepared: PreparedDiagram = field(repr=False)
    parts: tuple[Component | None, ...] = field(repr=False)
    """Component of each unit that its diagram draws; None for a group, which is of several."""
    usage: Usage
    hazard_rate: float
    """Hazard rate when new [1/h of operation]."""
    unknown: PartsOfUnknownRate | None
    """The effect of its parts of unknown rate."""

    def is_of(self, diagram: Block, parts: tuple[Component | None, ...], usage: Usage) -> bool:
        """Whether it is that of a level with this diagram, these very parts and this use, and none is of a group."""
        same = len(parts) == len(self.parts) and None not in parts and all(map(is_, parts, self.parts))
        return same and usage == self.usage and diagram == self.prepared.diagram


def levels_when_new(new: Outlook, before: Mapping[str, LevelWhenNew] | None = None) -> dict[str, LevelWhenNew]:
    """Return the levels of a new robot by path, the robot's own under an empty one.

    ``before``: those of another robot, by path; what is the same is taken from it. Raises RobophmError where no figures
    can be given.
    """
    before = before or {}
    robot = new.plant.robot
    part_of = {unit: part for part in new.plant.components for unit in part.units}
    found: dict[str, LevelWhenNew] = {}
    for path, module in robot.levels.items():
        parts = tuple(part_of.get(unit) for unit in units(module.diagram))
        known = before.get(path)
        if known and known.is_of(module.diagram, parts, robot.usage):
            found[path] = known
            continue
        rate, left_out = figures_now(new, module.diagram).hazard_rate, unknown(new, module.diagram)
        prepared = new.plant.system(module.diagram).prepared
        found[path] = LevelWhenNew(prepared, parts, robot.usage, rate, left_out)
    return found
