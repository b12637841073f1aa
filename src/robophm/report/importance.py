"""The page section on what matters most and what to replace first: the twenty that matter most."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from robophm.core.errors import StructureError
from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.health.importance import LIFELONG, Drawn, Importances, importances, usual_hours
from robophm.health.outlooks import View
from robophm.health.prognosis import Outlook
from robophm.health.replacement import Replacements, replacements
from robophm.report.bars import bars_svg
from robophm.report.markup import Html
from robophm.report.page import figure, table_html
from robophm.report.words import duration_text, more_text, number_text, odds_text, share_text

MOST = 20
"""Parts that are shown."""

MANY = 2000
"""Units from which on less is worked out, so that a page takes no longer than its other figures do."""

_FEW = 5
VIEWS: Mapping[View, str] = {"nominal": "nominal", "sensor_based": "sensor-based"}


def matters(robot: Robot, outlooks: Mapping[View, Outlook], median: float) -> Iterable[Html | str]:
    """Bars and a table of the most important parts; ``median`` is the robot's remaining life [h]."""
    lived = outlooks["sensor_based"]
    try:
        drawn = Drawn(lived.plant, robot.diagram)
    except StructureError as error:
        yield f"Importances are not stated: {error}."
        return
    many = len(drawn.structure.names) > LIFELONG
    hours = usual_hours(lived, median)
    found = {view: importances(outlooks[view], drawn, hours, lifelong=not many) for view in VIEWS}
    if found["sensor_based"].has_failed:
        yield "As far as is known the robot has failed: no part matters more than another."
        return
    yield from _matters(found, many)


def _matters(found: Mapping[View, Importances], many: bool) -> Iterable[Html | str]:
    one = found["sensor_based"]
    most = one.ranked()[:MOST]
    of = {view: {unit.unit: unit.criticality for unit in each.units} for view, each in found.items()}
    shares = {unit.unit: [of[view][unit.unit] for view in VIEWS] for unit in most}
    ahead = f"{number_text(one.hours)} h of operation"
    yield figure(
        bars_svg(shares, list(VIEWS.values()), title=f"Share of the failures within {ahead} that hang on a part"),
        "Criticality: given that the robot fails, the part has, and without that it would not; percent: sensor-based",
    )
    rows = [
        (unit.unit, unit.birnbaum, _percent(unit.criticality), _percent(unit.fussell_vesely), unit.achievement,
         unit.reduction, unit.improvement, _percent(unit.barlow_proschan))
        for unit in most
    ]  # fmt: skip
    columns = ("part", "Birnbaum", "criticality", "Fussell–Vesely", "RAW", "RRW", "improvement", "Barlow–Proschan")
    rest = len(one.units) - len(most)
    caption = f"Sensor-based, within {ahead}; Barlow–Proschan: share of all failures to come that it brings about"
    yield table_html(columns, rows, caption + (f"; {more_text(rest, 'shown')}" if rest else ""), "lrrrrrrr")
    if one.unknown:
        yield f"{one.unknown.aside}."
    if many:
        yield "Barlow–Proschan importances are not worked out for so many parts; `robophm importance` states them."


def replace_first(robot: Robot, outlooks: Mapping[View, Outlook], task: Task | None) -> Iterable[Html | str]:
    """A table of what replacing each part now would gain."""
    most = MOST if len(outlooks["sensor_based"].plant.units) <= MANY else _FEW
    found = {view: replacements(outlooks[view], robot.diagram, task, most) for view in VIEWS}
    lived = found["sensor_based"]
    nominal = {one.path: one for one in found["nominal"].parts}
    some = lived.changing
    if lived.unknown:
        yield f"{lived.unknown.aside}."
    if not some:
        yield "Nothing gains by being replaced: no part has aged, and no redundancy may have been lost."
        return
    rows = []
    for one in some[:MOST]:
        other = nominal.get(one.path)
        before = (other.completion, other.median) if other else (None, None)
        row: list[object] = [one.path]
        if task:
            row += [_signed(before[0], number_text), _signed(one.completion, number_text)]
        row += [_signed(before[1], duration_text), _signed(one.median, duration_text)]
        rows.append([*row, _signed(one.mean, duration_text)])
    columns = ["replaced now", *(["PoTC nominal", "PoTC sensor"] if task else [])]
    columns += ["median life nominal", "median life sensor", "mean life sensor"]
    yield table_html(columns, rows, _as_it_is(lived, len(some) - len(rows)), "l" + "r" * (len(columns) - 1))


def _as_it_is(found: Replacements, rest: int) -> str:
    text = f"median remaining life {duration_text(found.median)}, mean {duration_text(found.mean)}"
    left_out = found.unknown
    said = left_out.said_ahead(text) if left_out else text
    if found.completion_failure:
        fails = (odds_text(found.completion_failure) or "fails more often than 1 in 10").removeprefix("fails ")
        said += f"; the task fails {left_out.said(left_out.failing, fails) if left_out else fails}"
    unshown = rest + found.others
    return f"As it is: {said}" + (f"; {more_text(unshown, 'shown')}" if unshown else "")


def _percent(share: float) -> str | None:
    return None if math.isnan(share) else share_text(share)


def _signed(value: float | None, says: Callable[[float], str]) -> str | None:
    if value is None or math.isnan(value):
        return None
    return ("+" if value > 0 else "-" if value < 0 else "") + says(abs(value))
