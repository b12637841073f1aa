"""Two designs beside each other when new, and a design beside a requirement, as rows of tables and sentences."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from robophm.core.waiting_time import time_at
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import marked, marks, unknown
from robophm.report.words import MTBF, duration_text, number_text, percent_text, rate_text


class Requirement(NamedTuple):
    """A reliability through so many hours of operation that is asked of a new robot."""

    reliability: float
    hours: float


class NewFigures(NamedTuple):
    """The nominal figures of a new robot beside a requirement; texts carry the marks of parts of unknown rate."""

    hazard_rate: float
    mean_life: float
    """Mean life [h of calendar time]."""
    works: float
    """P(it works through the hours of the requirement)."""
    fails: float
    holds: float
    """Hours of operation through which it has the reliability that is required."""
    ahead: str
    """Mark on figures ahead where parts have unknown rates."""


def new_figures(new: Outlook, required: Requirement) -> NewFigures:
    """Return the figures of a new robot. Raises RobophmError where none can be given."""
    diagram = new.plant.robot.diagram
    state = new.survival_curve(diagram, np.array([required.hours]))
    survives = np.array([required.reliability])
    holds = float(time_at(new.curve(diagram, new.operating), 1 - survives, survives)[0])
    mean = new.remaining_life(diagram).mean
    ahead = marks(unknown(new, diagram))[2]
    return NewFigures(new.hazard_rate(diagram), mean, float(state.works[0]), float(state.failed[0]), holds, ahead)


def margin_text(found: NewFigures, required: Requirement) -> str:
    """Say whether a requirement is met, and by how much."""
    allowed = 1 - required.reliability
    met = found.works >= required.reliability
    times = allowed / found.fails if met else found.fails / allowed
    by = (
        f"{number_text(times, 3)} times as {'rarely' if met else 'often'} as allowed"
        if math.isfinite(times)
        else "never"
    )
    still = " by the parts whose rates are known" if found.ahead else ""
    return (
        f"{'Met' if met else 'Missed'}{still}: it fails within {number_text(required.hours)} h of operation with "
        f"{percent_text(found.fails, found.works)}, {by}; it has {percent_text(required.reliability, allowed)} through "
        f"{marked(found.ahead, duration_text(found.holds))}"
    )


def figure_rows(before: NewFigures, after: NewFigures, required: Requirement, unit: str) -> list[list[str]]:
    """Return rows of figures of two designs with the change from one to the other."""
    hours = number_text(required.hours)
    return [
        ["hazard rate when new", rate_text(before.hazard_rate, unit), rate_text(after.hazard_rate, unit),
         _share(before.hazard_rate, after.hazard_rate)],
        ["mean life (MTTF)", *(marked(one.ahead, duration_text(one.mean_life)) for one in (before, after)),
         _share(before.mean_life, after.mean_life)],
        [f"works through {hours} h", percent_text(before.works, before.fails, after.fails),
         percent_text(after.works, after.fails, before.fails),
         f"{_signed(100 * (before.fails - after.fails))} % points"],
        [f"has {percent_text(required.reliability)} through", *(marked(one.ahead, duration_text(one.holds)) for one in (
            before, after)), _share(before.holds, after.holds)],
    ]  # fmt: skip


def part_rows(before: Mapping[str, float], after: Mapping[str, float], unit: str) -> list[list[str]]:
    """Return rows of the parts whose rate is another, is new or is gone, the largest change first.

    ``before`` and ``after``: hazard rates when new by path, of all equal parts together [1/h].
    """
    paths = [one for one in {**before, **after} if not _same(before.get(one), after.get(one))]
    paths.sort(key=lambda one: -abs(after.get(one, 0.0) - before.get(one, 0.0)))
    return [
        [path, rate_text(before[path], unit) if path in before else "not in it",
         rate_text(after[path], unit) if path in after else "not in it",
         _signed(after.get(path, 0.0) - before.get(path, 0.0), unit)]
        for path in paths
    ]  # fmt: skip


def _same(one: float | None, other: float | None) -> bool:
    return one is not None and other is not None and (one == other or math.isclose(one, other, rel_tol=1e-9))


def _share(before: float, after: float) -> str:
    if not (math.isfinite(before) and math.isfinite(after)) or before == 0:
        return "unchanged" if before == after else "–"
    change = after / before - 1
    return "unchanged" if abs(change) < 1e-9 else f"{_signed(100 * change)} %"


def _signed(value: float, unit: str = "") -> str:
    text = rate_text(abs(value), "1/h" if unit == MTBF else unit) if unit else number_text(abs(value), 3)
    return text if value == 0 else f"{'+' if value > 0 else '−'}{text}"
