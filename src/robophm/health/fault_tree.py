"""The fault tree of a robot: its structure, and how likely each of its parts has failed since new."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.modular import LIMIT
from robophm.blocks.top_event import TopEvent
from robophm.core.errors import RobophmError
from robophm.design.robot import Robot
from robophm.health.plant import Parts
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.life.exponential import Exponential


@dataclass(frozen=True)
class RobotFaultTree(TopEvent):
    """The fault tree whose top event is the failure of a robot or function, and its basic events that units fail."""

    rates: Mapping[str, float] = field(default_factory=dict)
    """Hazard rates as designed [1/h of operation] of the units that fail at a constant one."""
    unknown: PartsOfUnknownRate | None = None
    """The effect of parts of unknown rate on the probabilities."""


def fault_tree(
    outlook: Outlook, function: str | None = None, hours: float = 0.0, *, limit: int = LIMIT
) -> RobotFaultTree:
    """Return the fault tree of the robot, or of a function by name, after so many more hours of operation than now.

    Beyond ``limit`` steps for a module of the tree it is too large to be solved. Raises RobophmError where hours are
    not finite or the robot has no such function.
    """
    if not math.isfinite(hours):
        raise RobophmError(f"{hours:g} h: expected a finite number")
    plant = outlook.plant
    diagram = plant.robot.diagram_of(function)
    tree = FaultTree.of(diagram, limit)
    works, failed = outlook.unit_survival(Parts(plant, [(name,) for name in tree.names]), np.array([hours]))
    return RobotFaultTree(tree, failed[:, 0], works[:, 0], constant_rates(plant.robot), unknown(outlook, diagram))


def constant_rates(robot: Robot) -> dict[str, float]:
    """The hazard rate as designed [1/h of operation] of every unit that fails at a constant one, by its name.

    A unit with a failure mode that ages by the calendar has none per hour of operation, and is left out.
    """
    found: dict[str, float] = {}
    for part in robot.all_components():
        if all(isinstance(mode.life, Exponential) and mode.clock != "calendar" for mode in part.modes):
            each = math.fsum(robot.usage.per_operating_hour(mode.clock) * mode.share * mode.rate for mode in part.modes)
            found |= dict.fromkeys(part.units, part.multiplicity * each)
    return found
