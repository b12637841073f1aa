"""What it takes to fail: single points of failure, and the minimal cut sets that are likeliest by now."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import islice, takewhile

import numpy as np
import numpy.typing as npt

from robophm.blocks.cut_sets import MinimalSet, MinimalSets
from robophm.blocks.diagram import units
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.merging import single_points_of_failure
from robophm.core.errors import StructureError
from robophm.design.robot import Robot
from robophm.health.prognosis import Outlook
from robophm.health.report import HealthReport
from robophm.report.markup import Html
from robophm.report.page import table_html
from robophm.report.words import count_text, more_text, number_text

ORDERS = 10
"""Numbers of sets are stated of 1, 2, … so many parts."""

STEPS = 100_000
"""That a page may take for each module of a robot's diagram and its minimal cut sets: a second or two."""

MOST_PARTS = 20_000
"""Of a robot whose sets a page lists."""

_MOST_LISTED = 10


class Listed:
    """Minimal sets, the likeliest of them listed; with an ``order`` the smallest, of at most so many parts.

    Raises StructureError where too many are alike in what they are sorted by.
    """

    def __init__(
        self, sets: MinimalSets, probability: npt.NDArray[np.float64], most: int, order: int | None = None
    ) -> None:
        self.count, self.by_order = sets.count(), sets.count_by_order(ORDERS)
        self.mass = sets.mass(probability)
        """Sum of the probabilities of all."""
        if order is None:
            found = sets.likeliest(probability)
        else:
            found = takewhile(lambda one: len(one.names) <= order, sets.smallest(probability))
        self.sets: list[MinimalSet] = list(islice(found, most))
        self.neglected = max(self.mass - math.fsum(one.probability for one in self.sets), 0.0)
        """Sum of those not listed."""
        if len(self.sets) == self.count:
            self.neglected = 0.0

    def counted(self, kind: str) -> str:
        """How many there are: "30 minimal cut sets: 12 of 1, 18 of 2"."""
        by_order = ", ".join(f"{count_text(n)} of {i}" for i, n in enumerate(self.by_order, 1) if n)
        rest = self.count - sum(self.by_order)
        more = f", {count_text(rest)} of more than {ORDERS}" if rest and by_order else ""
        return f"{count_text(self.count)} minimal {kind} sets: {by_order or f'all of more than {ORDERS}'}{more}"

    def left_out(self) -> str:
        """What those not listed add up to; "" where all are."""
        rest = self.count - len(self.sets)
        if not rest:
            return ""
        sums = "its probability is" if rest == 1 else "their probabilities add up to"
        return f"{more_text(rest, 'listed')}; {sums} {self.neglected:.3g}, of all {self.mass:.4g}."


def what_it_takes_to_fail(robot: Robot, report: HealthReport) -> Iterator[Html | str]:
    """The body of a section: from new to now, sensor-based."""
    parts = dict.fromkeys(units(robot.diagram))
    failed = failed_of(report.outlooks["sensor_based"])
    alone = sorted(single_points_of_failure(robot.diagram), key=lambda name: (-failed[name], name))
    if alone:
        more = f" and {len(alone) - _MOST_LISTED:,} more" if len(alone) > _MOST_LISTED else ""
        said = "one part fails" if len(alone) == 1 else f"{len(alone):,} parts fail"
        yield f"Of {len(parts):,} drawn, {said} the robot alone: {', '.join(alone[:_MOST_LISTED])}{more}."
    else:
        yield f"Of {len(parts):,} parts drawn, none fails the robot alone."
    try:
        if len(parts) > MOST_PARTS:
            raise StructureError(f"{len(parts)} parts")
        sets = MinimalSets(FaultTree.of(robot.diagram, STEPS))
        listed = Listed(sets, np.array([failed[name] for name in sets.names]), _MOST_LISTED)
    except StructureError:
        yield "What else fails it would take longer to find than a page may take; `robophm cutsets` has the time."
        return
    yield f"In all {listed.counted('cut')} parts."
    whole = report.system.sensor_based.unreliability
    rows = [
        (", ".join(one.names), len(one.names), one.probability, f"{number_text(100 * one.probability / whole, 3)} %")
        for one in listed.sets
        if whole > 0
    ]
    if rows:
        caption = "The likeliest sets of parts that are enough to fail the robot: that all of one have failed since new"
        yield table_html(("minimal cut set", "parts", "probability", "share of 1 − R"), rows, caption, "lrrr")
        if listed.left_out():
            yield listed.left_out()
        if unknown := report.system.unknown:
            yield f"{unknown.of_sets}."


def failed_of(outlook: Outlook) -> dict[str, float]:
    """The probability that each unit has failed since new."""
    plant = outlook.plant
    lived = plant.parts.of_units(outlook.cumulative_hazard[plant.parts.modes])
    of_units = dict(zip(plant.units[: len(lived)], map(float, -np.expm1(-lived)), strict=True))
    return of_units | {held.group.name: float(outlook.survival(held.group).failed) for held in plant.groups}
