"""The condition of the blocks of a diagram: how each is now, and its share of the failures to come."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Annotated, Literal

from fastapi import APIRouter, Query

from robophm.blocks.diagram import Block, Group
from robophm.core.errors import DesignError, nearest
from robophm.core.signal import SECOND
from robophm.health.failures_to_come import FailuresToCome
from robophm.health.limits import LimitedValue
from robophm.health.report import HealthReport
from robophm.health.reporting import health_report
from robophm.health.subject import FAILED, STALE
from robophm.report.failures_to_come import notes
from robophm.web.prepared_robot import finite
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/condition", tags=["condition"])


class BlockCondition(Shape):
    """The condition of a module or component."""

    path: str
    state: Literal["ok", "warn", "error", "stale", "idle"]
    """State now; "idle" where no limit is set, or nobody watches."""
    flags: list[str]
    """Flags that qualify its figures, such as of silent sensors."""
    hazard_rate: float | None
    """Sensor-based hazard rate now, of all equal parts together [1/h]."""
    nominal_hazard_rate: float | None
    share: float | None
    """P(a failure in it is the one that fails the robot within the horizon | the robot fails within it); null where
    that is not known of it alone: a part of unknown rate, or some of the parts that depend on each other."""


class Conditions(Shape):
    """The condition of what stands in one level of the design."""

    watched: bool
    time: float | None
    """The time of the samples that it is made of [s since the epoch]."""
    horizon: float | None
    """The time from now on in which failures are looked for [h of calendar time]; null before it is worked out."""
    stated: bool
    """Whether it was asked for; else it is the robot's median remaining life."""
    blocks: list[BlockCondition]
    notes: list[str]


@router.get("", responses=REFUSED)
def get_condition(
    service: Served, path: Annotated[str, Query(max_length=5000)] = "", whole: bool = False
) -> Conditions:
    """The condition of the modules and components of a level; with ``whole``, of all components in it."""
    run = service.monitoring.run
    report, lives = (run.report, run.lives) if run and run.report else (None, None)
    if report is None:
        prepared = service.prepared()
        exposure, ledger = service.past(prepared)
        report = lives = health_report(prepared.plant, exposure, ledger, wear=prepared.seen_wear(exposure, ledger))
    watched = run is not None and run.state == "running"
    return conditions(report, lives.failures_to_come if lives else None, path, whole=whole, watched=watched)


def conditions(
    report: HealthReport, found: FailuresToCome | None, path: str, *, whole: bool, watched: bool
) -> Conditions:
    """Return the condition of what is drawn of a level. Raises DesignError where there is no such level."""
    robot = report.design
    if (level := robot.levels.get(path)) is None:
        raise DesignError(f"no module '{path}'{nearest(path, robot.levels)}")
    below = f"{path}/" if path else ""
    shown = [one.path for one in level.modules] + [one.path for one in level.components]
    if whole:
        shown = [one.path for one in robot.all_components() if one.path.startswith(below)]
    wanted, values = set(shown), dict[str, tuple[list[str], float, float]]()
    for subject in report.subjects:
        if subject.kind == "module" and subject.path in wanted:
            rates = subject.sensor_based.hazard_rate, subject.nominal.hazard_rate
            values[subject.path] = [*subject.marks], *rates
    for part in report.components:
        if part.path in wanted:
            values[part.path] = [*part.flags], part.sensor_based_hazard_rate, part.nominal_hazard_rate
    shares = _shares(found, robot.diagram) if found else {}
    limits = defaultdict[str, list[LimitedValue]](list)
    for one in report.limited_values:
        if one.figure != "signal":
            limits[one.path].append(one)
    return Conditions(
        watched=watched,
        time=None if report.time is None else report.time / SECOND,
        horizon=found.horizon if found else None,
        stated=bool(found and found.stated),
        blocks=[
            BlockCondition(
                path=at, state=_state(limits[at], flags, watched=watched), flags=flags, hazard_rate=finite(now),
                nominal_hazard_rate=finite(nominal), share=finite(shares.get(at, math.nan)),
            )
            for at, (flags, now, nominal) in ((at, values[at]) for at in shown)
        ],
        notes=[*notes(found, found.contributions)] if found else [],
    )  # fmt: skip


def _state(
    limits: Sequence[LimitedValue], flags: Sequence[str], *, watched: bool
) -> Literal["ok", "warn", "error", "stale", "idle"]:
    broken = {one.severity for one in limits if one.broken}
    if "error" in broken or any(flag.startswith(FAILED) for flag in flags):
        return "error"
    if any(flag.startswith(STALE) for flag in flags):
        return "stale"
    if broken or flags:
        return "warn"
    return "ok" if limits and watched else "idle"


def _shares(found: FailuresToCome, diagram: Block) -> dict[str, float]:
    """The share of all that is within each path; none of what holds some of the parts of a group, and not all."""
    members, shares, split = dict(_groups(diagram)), dict[str, float](), set[str]()
    for one in found.contributions:
        parts = members.get(one.path, frozenset({one.path})) if one.group else frozenset({one.path})
        around = [frozenset(_around(part)) for part in parts]
        for path in frozenset.intersection(*around):
            shares[path] = shares.get(path, 0.0) + one.sensor_based
        split |= frozenset.union(*around) - frozenset.intersection(*around)
    return {path: share for path, share in shares.items() if path not in split}


def _around(path: str) -> Iterator[str]:
    """A path and those of the modules around it."""
    while path:
        yield path
        path = path.rpartition("/")[0]


def _groups(block: Block) -> Iterator[tuple[str, frozenset[str]]]:
    """The parts of each group of parts that depend on each other, by its name."""
    stack = [block]
    while stack:
        top = stack.pop()
        if isinstance(top, Group):
            yield top.name, frozenset(unit.partition("[")[0] for member in top.members for unit in member)
        else:
            stack += getattr(top, "blocks", ())
