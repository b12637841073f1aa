"""Answers as rows: ``robophm.rows`` for any program, ``robophm.frame`` for pandas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, is_dataclass
from functools import singledispatch
from typing import Any

from robophm.blocks.listed_sets import ListedSets
from robophm.calibration.score import Calibration
from robophm.core.argument_checks import shown
from robophm.core.errors import RobophmError
from robophm.design.robot import Robot
from robophm.health.importance import Importances
from robophm.health.report import HealthReport
from robophm.health.task_report import TaskReport
from robophm.health.what_matters import WhatMatters
from robophm.health.why import Explanation
from robophm.interface.asking import of_extra
from robophm.interface.faults import Diagnosed, Fmeca
from robophm.interface.field import Learned
from robophm.interface.wear import Wear
from robophm.learning.life_data.distribution_fitting import Fit
from robophm.learning.life_data.failure_modes import ModesFit
from robophm.learning.maintenance.upkeep import UpkeepPlan

Rows = list[dict[str, Any]]


def frame(answer: Any) -> Any:
    """The same as ``rows``, as a pandas DataFrame. Raises PlugError where pandas is not installed."""
    pandas = of_extra("pandas", "a data frame")
    return pandas.DataFrame(rows(answer))


@singledispatch
def rows(answer: Any) -> Rows:
    """An answer as a list of rows, each a mapping of a column to a number or text; times in hours.

    Of a robot: its failure modes; of a health report: robot, modules, functions and components; of importances: units;
    of fits, learned rates, wear, upkeep, effects of failures, suspects, cut sets, tasks, what decides, and models that
    were judged: one row each. Raises RobophmError for what is no answer.
    """
    if isinstance(answer, Sequence) and answer and all(isinstance(one, Fit) for one in answer):
        return [row for one in answer for row in rows(one)]
    if isinstance(answer, Sequence) and answer and all(is_dataclass(one) or hasattr(one, "_asdict") for one in answer):
        return [asdict(one) if is_dataclass(one) and not isinstance(one, type) else one._asdict() for one in answer]
    raise RobophmError(f"{shown(answer)} is no answer of robophm; expected a report, importances, fits, a robot …")


@rows.register
def _(answer: Robot) -> Rows:
    return [
        {
            "component": part.path, "quantity": part.quantity, "required": part.required, "failure_mode": mode.path,
            "rate": mode.rate or None, "clock": mode.clock, "life": type(mode.life).__name__.lower(),
            "source": mode.source,
            "signals": ", ".join(dict.fromkeys(one.signal for s in mode.stresses for one in s.channels.values())),
        }
        for part in answer.all_components() for mode in part.modes
    ]  # fmt: skip


@rows.register
def _(answer: HealthReport) -> Rows:
    found: Rows = []
    for one in answer.subjects:
        lived = one.sensor_based
        found.append({
            "kind": one.kind, "path": one.path, "quantity": 1,
            "nominal_hazard_rate": one.nominal.hazard_rate, "sensor_based_hazard_rate": lived.hazard_rate,
            "nominal_reliability": one.nominal.reliability, "sensor_based_reliability": lived.reliability,
            "median_remaining_life": lived.remaining_life and lived.remaining_life.median,
            "completion": lived.completion and lived.completion.probability,
            "unknown_rate": one.unknown is not None, "flags": ", ".join(one.flags),
        })  # fmt: skip
    for part in answer.components:
        found.append({
            "kind": "component", "path": part.path, "quantity": part.quantity,
            "nominal_hazard_rate": part.nominal_hazard_rate, "sensor_based_hazard_rate": part.sensor_based_hazard_rate,
            "nominal_reliability": part.nominal_reliability, "sensor_based_reliability": part.sensor_based_reliability,
            "median_remaining_life": part.remaining_life and part.remaining_life.median, "completion": None,
            "unknown_rate": part.unknown, "flags": ", ".join(part.flags),
        })  # fmt: skip
    return found


@rows.register
def _(answer: Importances) -> Rows:
    return [asdict(one) for one in answer.ranked()]


@rows.register
def _(answer: WhatMatters) -> Rows:
    return rows(answer.importances["sensor_based"])


@rows.register
def _(answer: Fit) -> Rows:
    row: dict[str, Any] = {"distribution": answer.name}
    for name, one in answer.parameters.items():
        row |= {name: one.value, f"{name}_low": one.low, f"{name}_high": one.high}
    quantiles = {f"b{100 * share:g}": one.value for share, one in answer.quantiles.items()}
    return [row | quantiles | {"mean": answer.mean, "aic": answer.aic, "straightness": answer.straightness}]


@rows.register
def _(answer: Learned) -> Rows:
    return [
        {"failure_mode": one.mode.path, "clock": one.mode.clock, "failures": one.failures, "expected": one.expected,
         "exposure": one.exposure, "stated_rate": one.stated, "learned_rate": one.rate,
         "low": one.stated * one.low, "high": one.stated * one.high}
        for one in answer.rates
    ]  # fmt: skip


@rows.register
def _(answer: Wear) -> Rows:
    return [
        {"failure_mode": one.mode.path, "source": one.source, "readings": len(one.values), "alarms": len(one.alarms),
         "followed": one.wear.followed, "worn_out": one.wear.worn_out,
         "median_by_hazard": answer.lives[one.mode.path].by_hazard.life.median,
         "median_with_wear": answer.lives[one.mode.path].with_wear.life.median}
        for one in answer.modes
    ]  # fmt: skip


@rows.register
def _(answer: UpkeepPlan) -> Rows:
    return [
        {"part": one.path, "clock": one.mode.clock, "replace_at": one.age, "every_hours": one.policy.age,
         "cost_per_hour": one.policy.cost_rate, "if_never": one.policy.never, "due_in_hours": one.due,
         "stops_robot": one.stops}
        for one in answer.parts
    ]  # fmt: skip


@rows.register
def _(answer: ModesFit) -> Rows:
    return [{"failure_mode": name, "first_in": answer.shares[name], **rows(one)[0]}
            for name, one in answer.modes.items()]  # fmt: skip


@rows.register
def _(answer: Fmeca) -> Rows:
    return [{**asdict(one), "rpn": one.rpn, "criticality": one.criticality} for one in answer.effects]


@rows.register
def _(answer: Diagnosed) -> Rows:
    if answer.diagnosis:
        return [one._asdict() for one in answer.diagnosis.suspects]
    return [
        {"failure_mode": mode, "sensor": sensor, "detects": chance}
        for mode, sees in answer.coverage.items() for sensor, chance in sees.items()
    ]  # fmt: skip


@rows.register
def _(answer: ListedSets) -> Rows:
    return [
        {"parts": ", ".join(one.names), "order": len(one.names), "probability": one.probability,
         "share": answer.share(one)}
        for one in answer.sets
    ]  # fmt: skip


@rows.register
def _(answer: TaskReport) -> Rows:
    return [
        {"task": one.task.name or f"task {i}", "distance": one.task.distance, "duration": one.task.duration,
         "nominal_completion": one.nominal.probability, "sensor_based_completion": one.sensor_based.probability}
        for i, one in enumerate(answer.tasks, 1)
    ]  # fmt: skip


@rows.register
def _(answer: Explanation) -> Rows:
    return [
        {"part": one.path, "quantity": one.quantity, "share": one.share, "pace": one.pace, "silent": one.silent,
         "median_if_relieved": one.relieved}
        for one in answer.parts
    ]  # fmt: skip


@rows.register
def _(answer: Calibration) -> Rows:
    return [
        {"model": one.model, "rejected": one.rejected, "tasks": one.tasks and one.tasks.tasks,
         "failed": one.tasks and one.tasks.failed, "expected": one.tasks and one.tasks.expected,
         "brier": one.tasks and one.tasks.brier.score, "lives": one.lives and one.lives.lives,
         "crps": one.lives and one.lives.crps}
        for one in answer.models
    ]  # fmt: skip
