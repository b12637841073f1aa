"""``robophm check``: whether a design is valid, and what in it is odd."""

from __future__ import annotations

from pathlib import Path

from robophm.cli.output import console, print_json, warn
from robophm.core.errors import DesignError
from robophm.design.file import load
from robophm.health.refusal import refusal


def run(design: Path, *, as_json: bool) -> None:
    """Warn of what is odd, and count what there is. Raises DesignError, too where no figures can be given for it."""
    robot = load(design)
    if not as_json:
        for warning in robot.warnings:
            warn(warning)
    if says := refusal(robot):
        raise DesignError(f"{design}: {says}")
    count = sum(component.quantity for component in robot.all_components()) - len(robot.causes)
    if as_json:
        print_json(
            {
                "robot": robot.name,
                "parts": count,
                "common_causes": len(robot.causes),
                "signals": list(robot.signals),
                "warnings": list(robot.warnings),
                "notes": list(robot.notes),
            }
        )
        return
    for note in robot.notes:
        warn(note, "note")
    console().print(
        f"{design}: {robot.name} is valid: {len(list(robot.all_modules()))} modules, {count} parts, "
        + (f"{len(robot.causes)} common causes, " if robot.causes else "")
        + f"{len(robot.signals)} signals, {len(robot.warnings)} warnings", markup=False
    )  # fmt: skip
