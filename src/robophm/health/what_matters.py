"""The units that matter most to a system and the parts to replace first, in each view of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from robophm.blocks.diagram import Block
from robophm.core.argument_checks import number
from robophm.design.task import Task
from robophm.health.importance import LONGEST, Drawn, Importances, importances, usual_hours
from robophm.health.outlooks import View
from robophm.health.prognosis import Outlook
from robophm.health.replacement import Replacements, replacements


@dataclass(frozen=True)
class WhatMatters:
    """The importance of each unit, and the gain of replacing each component."""

    importances: Mapping[View, Importances]
    """Importances in each view, all within the same hours of operation."""
    replacements: Mapping[View, Replacements]


def what_matters(
    views: Mapping[View, Outlook], diagram: Block, task: Task | None = None, hours: float | None = None
) -> WhatMatters:
    """Return importances and gains for a system in the views given, the sensor-based one among them.

    ``task``: what completion of it would gain is stated too; ``hours`` of operation ahead that importances are within:
    unless given ``usual_hours`` of the sensor-based median remaining life. Raises RobophmError where these are none,
    or beyond LONGEST.
    """
    if hours is not None:
        hours = number(hours, "hours", above=True, high=LONGEST)
    lived = views["sensor_based"]
    drawn = Drawn(lived.plant, diagram)
    gains = {view: replacements(outlook, diagram, task) for view, outlook in views.items()}
    within = usual_hours(lived, gains["sensor_based"].median) if hours is None else hours
    return WhatMatters({view: importances(outlook, drawn, within) for view, outlook in views.items()}, gains)
