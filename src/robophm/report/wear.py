"""The wear that sensors see, on every face: which parts, their time to the threshold, what changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from robophm.design.robot import Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.plant import Plant
from robophm.health.worn import SeenWear, apart
from robophm.monitoring.wear_over_time import wear_over_time
from robophm.report.curve import Line, curve_svg
from robophm.report.markup import Html
from robophm.report.page import figure, table_html
from robophm.report.words import more_text, number_text

LINES = 20
"""Failure modes that are listed one by one, the first to reach their thresholds."""

DRAWN = 4
"""Failure modes that are drawn on a page, the first to reach their thresholds; the course of each takes seconds."""

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


def wear_curves(robot: Robot, seen: Sequence[SeenWear], ledger: Mapping[str, Any]) -> Iterator[Html | str]:
    """Yield a plot of each of the first to reach their thresholds: readings, the course to come, and its band.

    ``ledger`` is that of which the wear was seen, as JSON.
    """
    settled = ExposureIntegrator(robot).settled(Ledger.of(robot, ledger))
    for one in ranked(seen)[:DRAWN]:
        found = wear_over_time(robot, settled, one.mode)
        if found is None or not len(found.readings.ages):
            continue
        ages, band = found.readings.ages, found.band
        end = ages[-1] if band is None else band.times[-1]
        lines = [Line("readings", ages, found.readings.values)]
        if band is not None:
            courses = {"course, 5 %": band.fast, "median": band.median, "95 %": band.slow}
            lines += [Line(name, band.times, course, dashed=True) for name, course in courses.items()]
        lines.append(Line("threshold", [ages[0], end], [one.threshold] * 2))
        caption = "Its readings alone foretell no course to the threshold"
        if band is not None:
            caption = "Dashed: the course that its own readings foretell, by its median and 90 % of what may come"
        age = f"age of the part [{one.unit}]"
        yield figure(curve_svg(lines, title=f"Wear of {one.mode}", x_label=age, y_label=one.signal), caption)
    if len(seen) > DRAWN:
        yield f"{more_text(len(seen) - DRAWN, 'drawn')}."
