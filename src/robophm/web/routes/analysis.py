"""Analysis: curves, what matters, what it takes to fail, what would be if."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from fastapi import APIRouter, Query
from pydantic import Field

from robophm.blocks.diagram import Block
from robophm.core.errors import DesignError, nearest
from robophm.core.json_values import plain
from robophm.drafting.first_look import look_at
from robophm.health.curve_span import curve_span
from robophm.health.fault_tree import fault_tree
from robophm.health.importance import LIFELONG, LONGEST, Drawn, importances, usual_hours
from robophm.health.prognosis import Outlook
from robophm.health.report import VIEWS
from robophm.health.unknown_rates import unknown
from robophm.report.first_look import advice, figure_rows
from robophm.report.minimal_sets import MOST_PARTS, STEPS, counted, left_out
from robophm.web.access.roles import needs
from robophm.web.health import Life, life_of
from robophm.web.prepared_robot import PreparedRobot, finite, unknown_of
from robophm.web.routes.design import REFUSED, apply
from robophm.web.service import Served, Service
from robophm.web.shapes import Operation, Shape, UnknownRates

router = APIRouter(prefix="/api/analysis", tags=["analysis"])

Numbers = list[float | None]
Hours = Annotated[float, Query(gt=0, le=LONGEST)]


class CurveOf(Shape):
    """Curves in one view, of survivors since new; a number for each of the hours."""

    reliability: Numbers
    unreliability: Numbers
    hazard_rate: Numbers
    density: Numbers
    remaining_life: Life
    hazard_rate_now: float | None
    """Hazard rate now, given that it works now."""


class Curves(Shape):
    """The curves of a level or function in both views."""

    path: str
    state: int
    hours: list[float]
    """Hours of operation from now on."""
    nominal: CurveOf
    sensor_based: CurveOf
    unknown: UnknownRates | None
    """The effect of parts of unknown rate on figures now and ahead; survivors' hazard rate is as if they never
    failed."""


class LifeOf(Shape):
    """The life of a new level, part or function, nominal."""

    path: str
    life: Life
    unknown: UnknownRates | None


Ratio = float | Literal["Infinity"] | None
"""A ratio, null where it does not apply. JSON has no infinite number: what removes every failure has a reduction worth
of it.
"""


class Importance(Shape):
    """The importance of one part; null where a measure says nothing."""

    part: str
    birnbaum: float | None
    criticality: float | None
    fussell_vesely: float | None
    achievement: Ratio
    reduction: Ratio
    improvement: float | None
    barlow_proschan: float | None


class ImportanceList(Shape):
    """The importance of parts, the most important first."""

    hours: float
    failure: float | None
    parts: list[Importance]
    more: int
    refused: str
    unknown: UnknownRates | None


class RobotRanges(Shape):
    """Ranges of a robot's figures that come of its uncertain rates."""

    rows: list[list[str]]
    """The name of a figure, and its 5 %, 50 % and 95 % quantiles; no rows where all rates are exactly known."""
    advice: list[str]
    """Sentences that say whom to ask for which figure; the one that would narrow the ranges most is first."""


class CutSet(Shape):
    """Parts whose failure together is enough to fail the robot."""

    parts: list[str]
    probability: float | None


class CutSets(Shape):
    """Minimal cut sets, the likeliest by now first."""

    counted: str
    sets: list[CutSet]
    left_out: str
    unknown: str
    """Note on parts of unknown rate; "" where there are none."""


class WhatIfAsked(Shape):
    """Edits to be tried without making them."""

    operations: Annotated[list[Operation], Field(min_length=1, max_length=1000)]
    path: Annotated[str, Field(max_length=5000)] = ""
    horizon: Annotated[float, Field(gt=0, le=LONGEST)] | None = None


class WhatIf(Shape):
    """The curves before and after the edits that are tried."""

    baseline: Curves
    changed: Curves


def _system(prepared: PreparedRobot, path: str) -> Block:
    module = prepared.modules.get(path)
    if module is not None:
        return module.diagram
    functions = prepared.robot.functions
    if path in functions:
        return functions[path]
    for i, part in enumerate(prepared.plant.components):
        if part.path == path:
            return prepared.plant.alone[i]
    known = (*prepared.modules, *functions, *(part.path for part in prepared.plant.components))
    raise DesignError(f"no level, part or function '{path}'{nearest(path, known)}")


def curves(
    service: Service, prepared: PreparedRobot, path: str, horizon: float | None, points: int, state: int
) -> Curves:
    """Return survival, hazard and density ahead in both views."""
    diagram = _system(prepared, path)
    views = service.outlooks(prepared)
    lives = {view: views[view].remaining_life(diagram) for view in VIEWS}
    if horizon is None:
        horizon = curve_span(lives.values(), prepared.robot.usage.operating)
    hours = np.linspace(0.0, horizon, points)
    return Curves(
        path=path,
        state=state,
        hours=hours.tolist(),
        nominal=_curve(views["nominal"], diagram, hours, life_of(lives["nominal"])),
        sensor_based=_curve(views["sensor_based"], diagram, hours, life_of(lives["sensor_based"])),
        unknown=unknown_of(unknown(views["sensor_based"], diagram)),
    )


def _curve(outlook: Outlook, diagram: Block, hours: Any, life: Life) -> CurveOf:
    state = outlook.survival_curve(diagram, hours)
    return CurveOf(
        reliability=_numbers(state.works),
        unreliability=_numbers(state.failed),
        hazard_rate=_numbers(outlook.hazard_curve(diagram, hours)),
        density=_numbers(state.density),
        remaining_life=life,
        hazard_rate_now=finite(outlook.hazard_rate(diagram)),
    )


def _numbers(values: Any) -> Numbers:
    return [finite(float(value)) for value in values]


@router.get("/curves", responses=REFUSED)
def get_curves(
    service: Served,
    path: Annotated[str, Query(max_length=5000)] = "",
    horizon: Hours | None = None,
    points: Annotated[int, Query(ge=2, le=1000)] = 200,
    state: Annotated[int, Query(ge=1, le=2**53)] | None = None,
) -> Curves:
    """The curves of the robot (empty path), a level, a part or a function; of the design now or as it was."""
    prepared = service.prepared(state)
    return curves(service, prepared, path, horizon, points, state or service.workspace.draft().state)


@router.get("/life", responses=REFUSED)
def get_life(service: Served, path: Annotated[str, Query(max_length=5000)] = "") -> LifeOf:
    """The life of the robot (empty path), a level, a part or a function when new, nominal [h of calendar time]."""
    prepared = service.prepared()
    diagram = _system(prepared, path)
    life = life_of(prepared.new.remaining_life(diagram))
    return LifeOf(path=path, life=life, unknown=unknown_of(unknown(prepared.new, diagram)))


@router.post("/what-if", responses=REFUSED)
@needs("viewer")
def what_if(asked: WhatIfAsked, service: Served) -> WhatIf:
    """The design now beside what it would be with some edits; nothing is changed."""

    def change(document: Any) -> None:
        for operation in asked.operations:
            apply(document, operation)

    baseline = service.prepared()
    changed = service.prepared_text(service.workspace.edited(change))
    state = service.workspace.draft().state
    before = curves(service, baseline, asked.path, asked.horizon, 200, state)
    return WhatIf(baseline=before, changed=curves(service, changed, asked.path, before.hours[-1], 200, state))


@router.get("/importance", responses=REFUSED)
def get_importance(
    service: Served,
    path: Annotated[str, Query(max_length=5000)] = "",
    hours: Hours | None = None,
    most: Annotated[int, Query(ge=1, le=1000)] = 30,
) -> ImportanceList:
    """The importance of parts, sensor-based, given what is known now."""
    prepared = service.prepared()
    lived = service.outlooks(prepared)["sensor_based"]
    diagram = _system(prepared, path)
    drawn = Drawn(prepared.plant, diagram)
    ahead = hours or usual_hours(lived, lived.remaining_life(diagram).median)
    found = importances(lived, drawn, ahead, lifelong=len(drawn.structure.names) <= LIFELONG)
    ranked = found.ranked()
    measures = Importance.model_fields.keys() - {"part"}
    parts = [
        Importance(part=one.unit, **{name: plain(getattr(one, name)) for name in measures}) for one in ranked[:most]
    ]
    return ImportanceList(hours=ahead, failure=finite(found.failure), parts=parts, more=len(ranked) - len(parts),
                          refused=found.refused, unknown=unknown_of(found.unknown, "aside"))  # fmt: skip


def few_enough(prepared: PreparedRobot, command: str) -> None:
    """Raise DesignError where there are more parts than may keep everybody waiting; the command has the time."""
    if (count := len(prepared.plant.units)) > MOST_PARTS:
        raise DesignError(f"{count:,} parts; expected at most {MOST_PARTS:,}: `robophm {command}` has the time")


@router.get("/cut-sets", responses=REFUSED)
def get_cut_sets(service: Served, most: Annotated[int, Query(ge=1, le=1000)] = 20) -> CutSets:
    """The smallest sets of parts whose failure fails the robot, the likeliest by now first."""
    prepared = service.prepared()
    few_enough(prepared, "cutsets")
    views = service.outlooks(prepared)
    system = fault_tree(views["sensor_based"], limit=STEPS)
    listed = system.cut_sets(most)
    found = [CutSet(parts=list(one.names), probability=finite(one.probability)) for one in listed.sets]
    says = f"{system.unknown.of_sets}." if system.unknown else ""
    return CutSets(counted=counted(listed), sets=found, left_out=left_out(listed), unknown=says)


@router.get("/ranges", responses=REFUSED)
def get_ranges(service: Served) -> RobotRanges:
    """The robot's figures as ranges while its rates are uncertain, and whose rate it would help most to know."""
    prepared = service.prepared()
    if not any(mode.uncertainty for mode in prepared.robot.modes):
        return RobotRanges(rows=[], advice=[])
    found = look_at(prepared.robot, service.outlooks(prepared)["sensor_based"])
    return RobotRanges(rows=[list(row) for row in figure_rows(found)], advice=list(advice(found)))
