"""Failures that robots of a fleet promised over the last thirty days, against those that were noted, by cohort."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

from robophm.calibration.honest_past import MONTH, MOST_POINTS, Noted, tells_nothing
from robophm.calibration.promised_failures import LEVEL, CountedFailures
from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.fleet.cohorts import KINDS
from robophm.fleet.experience import NO_LEDGER, NOT_WORKED, UNREADABLE, kept_ledgers
from robophm.fleet.questions import newest_time
from robophm.fleet.robot_history import history
from robophm.fleet.store import FleetStore
from robophm.health.plant import Plant
from robophm.learning.rates.cohorts import adjusted


class CohortCalibration(NamedTuple):
    """The failures that the robots of one cohort promised, against those that were noted."""

    cohort: str
    robots: int
    counted: CountedFailures
    chance: float
    """The chance of a count as far off, if the promises were right, as if it were the only cohort (Holm)."""

    @property
    def rejected(self) -> bool:
        """Return whether the count speaks against what was promised."""
        return self.chance < LEVEL

    def to_json(self) -> dict[str, Any]:
        """Return it as plain values for JSON."""
        return {
            "cohort": self.cohort, "robots": self.robots, **asdict(self.counted), "alone": self.counted.chance,
            "chance": self.chance, "rejected": self.rejected,
        }  # fmt: skip


class FleetCalibration(NamedTuple):
    """The calibration of a fleet over the last thirty days of each robot's reports."""

    cohorts: tuple[CohortCalibration, ...]
    together: CountedFailures
    robots: int
    not_told: dict[str, str]
    """Robots whose promises are not counted, and why."""


def calibrate(store: FleetStore, designs: Sequence[Robot], kind: str) -> FleetCalibration:
    """Count the failures that robots of some designs promised, cohort by cohort of a kind, against those noted.

    Of each robot the last thirty days before its newest report count, or as long as it has reported; failures of parts
    without which it goes on do not. ``kind``: one of KINDS. Raises DataError where no robot has promised anything.
    """
    plants = {one.name: Plant(one) for one in designs}
    silent = {name for name, plant in plants.items() if tells_nothing(plant)}
    counted: dict[str, list[CountedFailures]] = defaultdict(list)
    every, not_told = list[CountedFailures](), dict[str, str]()
    for one in kept_ledgers(store, designs):
        if one.ledger is None:
            not_told[one.robot] = one.why
        elif one.ledger.started is None:
            not_told[one.robot] = NOT_WORKED
        elif one.design in silent:
            not_told[one.robot] = "has parts of unknown rate in its figures"
        else:
            last = (newest_time(store, one.robot) or 0) + 1
            series = history(store, one.robot, last - MONTH, last, MOST_POINTS).series
            try:
                span = Noted(plants[one.design], one.ledger).span(series, last)
                cohort = KINDS[kind](one.origin) or "not stated"
            except NO_LEDGER:
                not_told[one.robot] = UNREADABLE
                continue
            if span is None:
                not_told[one.robot] = "has no figures that tell: fewer than two reports, or a past that was revised"
                continue
            every.append(span.counted)
            counted[cohort].append(span.counted)
    if not every:
        raise DataError(f"{store.place}: no robot of {', '.join(plants)} has promised anything that can be counted; "
                        "expected two reports and a ledger of one at least")  # fmt: skip
    sums = {name: _sum(some) for name, some in sorted(counted.items())}
    chances = adjusted([one.chance for one in sums.values()])
    cohorts = tuple(CohortCalibration(name, len(counted[name]), one, chance)
                    for (name, one), chance in zip(sums.items(), chances, strict=True))  # fmt: skip
    return FleetCalibration(cohorts, _sum(every), len(every), not_told)


def _sum(some: Sequence[CountedFailures]) -> CountedFailures:
    """Robots fail independently if their promises are right, and sums of Poisson counts are Poisson."""
    return CountedFailures(sum(one.promised for one in some), sum(one.noted for one in some))
