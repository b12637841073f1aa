"""When inspections should replace which part, by others of its kind that wore out, or by its own readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.learning.maintenance.condition_based import ConditionPolicy, WearPaths, best_condition_policy
from robophm.learning.maintenance.upkeep import PartPlan, UpkeepPlan
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.possible_paths import PossiblePaths, paths_of_forecast, paths_of_others
from robophm.learning.wear.teachers import teachers_of
from robophm.learning.wear.worn_mode import WearOptions
from robophm.monitoring.seen_wear import worn_of


class ByCondition(NamedTuple):
    """The best policy of one part, in the terms of its signal."""

    policy: ConditionPolicy
    """The policy, in the unit of the part's clock."""
    level: float
    """Level of the signal at which an inspection replaces the part."""
    pace: float
    """Units that the clock advances in a calendar hour."""
    known: int
    """Others that wore out by which it is known; 0: by the forecast of this part alone."""


def by_condition(
    robot: Robot, plan: UpkeepPlan, ledger: Ledger | None
) -> tuple[Mapping[str, ByCondition], Mapping[str, str]]:
    """Return the policies of parts whose inspections have a cost, by path, and why there is none of the others.

    Wear counts from the level at which readings began, as one of a new part. Raises DataError where a table of teachers
    is none.
    """
    found: dict[str, ByCondition] = {}
    missed: dict[str, str] = {}
    teachers = teachers_of(robot)
    for one in plan.parts:
        if one.costs.inspection is None:
            continue
        try:
            found[one.path] = _of_part(one, ledger, one.costs.inspection, teachers.get(one.mode.path, ()))
        except DataError as error:
            missed[one.path] = str(error)
    return found, missed


def _of_part(one: PartPlan, ledger: Ledger | None, inspection: float, others: Sequence[Unit]) -> ByCondition:
    paths = _paths(one, ledger, others)
    own = one.standing
    costs = replace(
        own, preventive_downtime=own.preventive_downtime * one.pace,
        corrective_downtime=own.corrective_downtime * one.pace, repair=None,
    )  # fmt: skip
    policy = best_condition_policy(WearPaths(paths.wear, paths.lives, paths.noise), costs, inspection)
    return ByCondition(policy, paths.new + policy.level * paths.way, one.pace, paths.known)


def _paths(one: PartPlan, ledger: Ledger | None, others: Sequence[Unit]) -> PossiblePaths:
    """Paths of others, where some wore out; else those of its own forecast."""
    said = one.mode.wear
    if said is None:
        raise DataError("the design says no signal of its wear")
    course = ledger.wear.get(one.mode.key) if ledger else None
    read = course.readings(said) if course else None
    if others:
        if read is not None and len(read.ages) > 1 and (np.diff(read.ages) > 0).all():
            others = [*others, Unit(read.ages, read.values)]
        return paths_of_others(others, said.threshold)
    if read is None:
        raise DataError("no readings of its wear, and no teachers in the design; expected a store that has some")
    worn = worn_of(one.mode, read, WearOptions(changes=False))
    return paths_of_forecast(worn.wear, read.ages, read.values)
