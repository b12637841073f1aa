"""The page section on what it takes to fail: single points of failure, and the likeliest minimal cut sets."""

from __future__ import annotations

import math
from collections.abc import Iterator

from robophm.blocks.diagram import units
from robophm.blocks.listed_sets import ORDERS, ListedSets
from robophm.blocks.single_points import single_points_of_failure
from robophm.core.errors import StructureError
from robophm.design.robot import Robot
from robophm.health.fault_tree import fault_tree
from robophm.health.report import HealthReport
from robophm.report.markup import Html
from robophm.report.page import table_html
from robophm.report.words import count_text, more_text, share_text

STEPS = 100_000
"""Steps that a page may take for each module of a robot's diagram and its minimal cut sets: a second or two."""

MOST_PARTS = 20_000
"""The most parts of a robot whose sets a page lists."""

_MOST_LISTED = 10


def counted(listed: ListedSets, kind: str = "minimal cut set") -> str:
    """The number of sets in words: "30 minimal cut sets: 12 of 1, 18 of 2"."""
    sets = kind if listed.count == 1 else f"{kind}s"
    if math.isinf(listed.cut_off):
        return f"{count_text(listed.count)} {sets} found in this time; there are others, and there may be likelier ones"
    by_order = ", ".join(f"{count_text(n)} of {i}" for i, n in enumerate(listed.by_order, 1) if n)
    rest = listed.count - sum(listed.by_order)
    more = f", {count_text(rest)} of more than {ORDERS}" if rest and by_order else ""
    least = f"at least {listed.cut_off:g} times as likely as their module" if listed.cut_off else ""
    some = f" {least}, with some of the less likely" if least else ""
    return f"{count_text(listed.count)} {sets}{some}: {by_order or f'all of more than {ORDERS}'}{more}"


def left_out(listed: ListedSets) -> str:
    """A note on the sum over sets that are not listed; empty where all are."""
    rest = listed.count - len(listed.sets)
    if not rest:
        return ""
    if math.isnan(listed.neglected):
        return f"{more_text(rest, 'listed')}."
    sums = "its probability is" if rest == 1 else "their probabilities add up to"
    return f"{more_text(rest, 'listed')}; {sums} {listed.neglected:.3g}, of all {listed.mass:.4g}."


def what_it_takes_to_fail(robot: Robot, report: HealthReport) -> Iterator[Html | str]:
    """The body of a section: from new to now, sensor-based."""
    parts = dict.fromkeys(units(robot.diagram))
    system = fault_tree(report.outlooks["sensor_based"], limit=STEPS)
    failed = dict(zip(system.tree.names, system.occurred.tolist(), strict=True))
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
        listed = system.cut_sets(_MOST_LISTED)
    except StructureError:
        yield "What else fails it would take longer to find than a page may take; `robophm cutsets` has the time."
        return
    yield f"In all {counted(listed)} parts."
    rows = [
        (", ".join(one.names), len(one.names), one.probability, share_text(listed.share(one)))
        for one in listed.sets
        if listed.whole > 0
    ]
    if rows:
        caption = "The likeliest sets of parts that are enough to fail the robot: that all of one have failed since new"
        yield table_html(("minimal cut set", "parts", "probability", "share of 1 − R"), rows, caption, "lrrr")
        if rest := left_out(listed):
            yield rest
        if unknown := report.system.unknown:
            yield f"{unknown.of_sets}."
