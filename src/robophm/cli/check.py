"""``robophm check``: whether a design is valid, and what in it is odd."""

from __future__ import annotations

from robophm.cli.shared.options import Design, Json
from robophm.cli.shared.output import console, print_json, warn
from robophm.core.errors import DesignError
from robophm.design.file import load
from robophm.health.refusal import refusal
from robophm.health.unknown_rates import named, unknown_in_parts
from robophm.parts import graded
from robophm.report.surroundings import environments, environments_in_words, qualities, qualities_in_words
from robophm.report.words import many_text


def command(design: Design, as_json: Json = False) -> None:
    """Check a design for errors, and warn of odd values."""
    robot = load(design)
    if not as_json:
        for warning in robot.warnings:
            warn(warning)
    if says := refusal(robot):
        raise DesignError(f"{design}: {says}")
    if any(mode.wear and mode.wear.teachers for mode in robot.modes):
        from robophm.learning.wear.teachers import teachers_of  # what foretells wear takes long to load

        teachers_of(robot)
    left_out = unknown_in_parts(robot.all_components())
    warnings = list(robot.warnings)
    if left_out:
        warnings.append(f"{left_out.left_out} ({named(robot)})")
    driven = sum(part.quantity for part in robot.all_components() if part.sensed)
    entries = {robot.part_of(mode): said for mode in robot.modes if (said := graded(mode.source))}
    if as_json:
        print_json(
            {
                "robot": robot.name,
                "parts": robot.part_count,
                "parts_of_unknown_rate": left_out.parts if left_out else 0,
                "parts_no_sensor_drives": robot.part_count - driven,
                "common_causes": len(robot.causes),
                "signals": list(robot.signals),
                "warnings": warnings,
                "notes": list(robot.notes),
                "environments": environments(robot),
                "qualities": qualities(robot),
                "library": [{"path": mode.path, "source": mode.source} for mode in robot.modes if graded(mode.source)],
            }
        )
        return
    if left_out:
        warn(warnings[-1])
    for note in robot.notes:
        warn(note, "note")
    for line in (*environments_in_words(robot), *qualities_in_words(robot)):
        warn(line, "note")
    if entries:
        warn("by the library of parts: " + "; ".join(f"{path} ({said})" for path, said in entries.items()), "note")
    console().print(
        f"{design}: {robot.name} is valid: {many_text(len(list(robot.all_modules())), 'module')}, "
        f"{many_text(robot.part_count, 'part')}, "
        + (f"{left_out.parts} of them of unknown rate, " if left_out else "")
        + f"{robot.part_count - driven} that no sensor drives, "
        + (f"{many_text(len(robot.causes), 'common cause')}, " if robot.causes else "")
        + f"{many_text(len(robot.signals), 'signal')}, {many_text(len(warnings), 'warning')}",
        markup=False, soft_wrap=True,
    )  # fmt: skip
