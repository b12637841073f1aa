"""When inspections should replace which part, by the law that a robot's readings of wear say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from robophm.core.errors import DataError
from robophm.health.ledger import Ledger
from robophm.learning.maintenance.condition_based import ConditionPolicy, GammaWear, best_condition_policy
from robophm.learning.maintenance.upkeep import PartPlan, UpkeepPlan
from robophm.learning.wear.worn_mode import begins_at


class ByCondition(NamedTuple):
    """The best policy of one part, in the terms of its signal."""

    policy: ConditionPolicy
    """The policy, in the unit of the part's clock."""
    level: float
    """Level of the signal at which an inspection replaces the part."""
    pace: float
    """Units that the clock advances in a calendar hour."""
    readings: int


def by_condition(plan: UpkeepPlan, ledger: Ledger | None) -> tuple[Mapping[str, ByCondition], Mapping[str, str]]:
    """Return the policies of parts whose inspections have a cost, by path, and why there is none of the others.

    Wear counts from the level at which readings began, as one of a new part.
    """
    found: dict[str, ByCondition] = {}
    missed: dict[str, str] = {}
    for one in plan.parts:
        if one.costs.inspection is None:
            continue
        try:
            found[one.path] = _of_part(one, ledger, one.costs.inspection)
        except DataError as error:
            missed[one.path] = str(error)
    return found, missed


def _of_part(one: PartPlan, ledger: Ledger | None, inspection: float) -> ByCondition:
    said = one.mode.wear
    if said is None:
        raise DataError("the design says no signal of its wear")
    course = ledger.wear.get(one.mode.key) if ledger else None
    if course is None:
        raise DataError("no readings of its wear; expected a store that has some")
    read = course.readings(said)
    begun = begins_at(read.values) if len(read.values) else 0.0
    sign = 1.0 if said.threshold > begun else -1.0
    wear = GammaWear.of_readings(read.ages, sign * (read.values - begun), sign * (said.threshold - begun))
    own = one.standing
    costs = replace(
        own, preventive_downtime=own.preventive_downtime * one.pace,
        corrective_downtime=own.corrective_downtime * one.pace, repair=None,
    )  # fmt: skip
    policy = best_condition_policy(wear, costs, inspection)
    return ByCondition(policy, begun + sign * policy.threshold, one.pace, len(read.values))
