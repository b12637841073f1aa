"""The meaning of alarms, and which sensor sees what, in the rows of tables and in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from robophm.design.robot import Robot
from robophm.health.unknown_rates import marks, named, unknown_in_parts
from robophm.learning.diagnosis.fault_isolation import Diagnosis, Sensor
from robophm.report.words import more_text, number_text, percent_text

MOST_SUSPECTS = 15
"""The most suspects that are listed, of those whose rate is known, and of those whose rate is unknown."""


def coverage_rows(
    sensors: Sequence[Sensor], coverage: Mapping[str, Mapping[str, float]]
) -> tuple[list[str], list[list[str]]]:
    """Return columns and rows of P(alarm | failure) by failure mode and sensor; those in brackets are not fitted."""
    names = [sensor.name for sensor in sensors]
    rows = [
        [mode, *(number_text(sees[n], 3) if n in sees else "" for n in names), "yes" * ("monitored" in sees)]
        for mode, sees in coverage.items()
    ]
    return ["failure mode", *(s.name if s.fitted else f"({s.name})" for s in sensors), "monitored"], rows


def suspect_rows(robot: Robot, found: Diagnosis, hours: float) -> tuple[list[str], list[list[str]]]:
    """Return columns and rows of the likeliest faults; first those of which it is not known how likely they are."""
    mark = marks(unknown_in_parts(robot.all_components()) if found.rivals else None)[2]
    shown = [one for one in found.suspects if math.isnan(one.before)][:MOST_SUSPECTS]
    shown += [one for one in found.suspects if not math.isnan(one.before)][:MOST_SUSPECTS]
    rows = [
        [one.fault,
         "unknown" if math.isnan(one.probability) else mark + percent_text(one.probability),
         "unknown" if math.isnan(one.before) else number_text(one.before, 3),
         "–" if math.isnan(one.odds) else number_text(one.odds, 3)]
        for one in shown
    ]  # fmt: skip
    return ["", "now", f"before, in {number_text(hours)} h", "odds, times"], rows


def nothing_failed(robot: Robot, found: Diagnosis, *, alarmed: bool) -> str:
    """Say how likely it is that nothing has failed."""
    most = marks(unknown_in_parts(robot.all_components()))[1] if found.no_fault else ""
    false = ", and it is a false alarm" if alarmed else ""
    return f"Nothing has failed{false}: {most}{percent_text(found.no_fault)}"


def unknown_suspects(robot: Robot, found: Diagnosis) -> Iterator[str]:
    """Say what parts of unknown rate mean for a diagnosis; nothing where there are none."""
    if left_out := unknown_in_parts(robot.all_components()):
        says = left_out.aside if found.rivals else f"{left_out.words} may have failed as well: how likely is not known"
        yield f"{says} ({named(robot)})"
        if (more := sum(math.isnan(one.before) for one in found.suspects) - MOST_SUSPECTS) > 0:
            yield f"of unknown rate {more_text(more, 'listed')}"
