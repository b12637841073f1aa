"""The wear that sensors see, on every face: which parts, their time to the threshold, what changed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from robophm.health.plant import Plant
from robophm.health.worn import SeenWear, apart
from robophm.report.markup import Html
from robophm.report.page import table_html
from robophm.report.words import number_text

LINES = 20
"""Failure modes that are listed one by one, the first to reach their thresholds."""

ALARMS = 3
"""Changes of one signal that are listed, the latest."""


def wear_lines(seen: Sequence[SeenWear], plant: Plant) -> list[tuple[str, bool]]:
    """A line for each failure mode that is seen to wear, the first to reach its threshold first; whether it is bad."""
    lines = [(f"{one.mode}: {says(one, plant)}", one.critical) for one in ranked(seen)[:LINES]]
    if more := len(seen) - LINES:
        lines += [(f"{more} more are seen to wear", False)] if more > 0 else []
    return lines


def ranked(seen: Iterable[SeenWear]) -> list[SeenWear]:
    """Return critical wear first, then that which comes first to its threshold."""
    return sorted(seen, key=lambda one: (not one.critical, one.median))


def says(one: SeenWear, plant: Plant) -> str:
    """Return all that is to be said of one of them."""
    alone = ""
    if dependent(one, plant):
        alone = "; its part's life depends on others', so that its hazard counts"
    alarms = [alarm.words for alarm in (one.alarms or ())[-ALARMS:]]
    return "; ".join((one.says + alone, *alarms))


def dependent(one: SeenWear, plant: Plant) -> bool:
    """Whether its part is in a group of parts that depend on each other, whose wear is not told apart."""
    return any(plant.robot.modes[i].path == one.mode for i in apart(plant))


def wear_table(seen: Sequence[SeenWear], plant: Plant) -> Iterable[Html | str]:
    """Return the same as a section of a page."""
    rows = [
        (one.mode, one.signal, number_text(one.last) if one.last is not None else None, number_text(one.threshold),
         str(one.readings), says(one, plant))
        for one in ranked(seen)
    ]  # fmt: skip
    columns = ("failure mode", "signal", "last reading", "threshold", "readings", "what it says")
    yield table_html(columns, rows, "sensor-based figures have this wear in the place of the mode's hazard", "llrrrl")
    for one in seen:
        if one.alarms is None and one.unlooked:
            yield f"{one.mode}: changes of its signal are not looked for: {one.unlooked}."
