"""A robot that asks before it goes: how far it would come, as leg after leg multiplies."""

from __future__ import annotations

import math

import pytest

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.health.mission import consecutive_completions
from robophm.health.outlooks import outlooks
from robophm.health.task_assessment import assess
from robophm.monitoring.monitor import Monitor

DESIGN = """
schema_version: 1
name: R
thresholds: {completion: 0.9}
components:
  left: {rate: 0.3 /h}
  right: {rate: 0.2 /h}
  lamp: {rate: 0.05 /h, life: {distribution: weibull, shape: 2}}
functions:
  drive: {parallel: [left, right]}
  see: lamp
"""
TASK = Task((
    Leg(0.5, 100.0, functions=("drive",)), Leg(0.25, 50.0, functions=("see",)), Leg(0.5, 10.0, functions=("drive",)),
    Leg(1.0, 10.0, functions=("see", "drive")),
))  # fmt: skip


@pytest.mark.parametrize("limit", [0.0, 0.5, 0.9, 0.95, 0.99, 0.999, 1.0])
def test_the_longest_prefix_is_what_leg_after_leg_multiplies_to(limit: float) -> None:
    """Each leg given those before it, all functions of the whole task working now: the product is the prefix's."""
    monitor = Monitor(parse(DESIGN))
    found = assess(monitor.plant, monitor.exposure, monitor.ledger, TASK, limit=limit)
    lived = outlooks(monitor.plant, monitor.exposure, monitor.ledger)["sensor_based"]
    chance, most = 1.0, 0
    for legs, one in enumerate(consecutive_completions(lived, [Task((leg,)) for leg in TASK.legs]), 1):
        chance *= one.probability
        most = legs if chance >= limit else most
    assert found.longest_prefix == most
    assert found.go == (most == 4)
    assert found.report.together["sensor_based"].probability == pytest.approx(chance, rel=1e-12)


def test_exponential_parts_in_series_by_hand() -> None:
    """At 0.1 failures an hour 0.9 is kept for ln(1/0.9)/0.1 = 1.0536 h: ten legs of six minutes, and not eleven."""
    monitor = Monitor(parse("schema_version: 1\nname: R\ncomponents: {a: {rate: 0.04 /h}, b: {rate: 0.06 /h}}"))
    task = Task(tuple(Leg(0.1) for _ in range(30)))
    found = assess(monitor.plant, monitor.exposure, monitor.ledger, task, limit=0.9)
    assert (found.longest_prefix, found.go) == (10, False)
    assert found.report.together["nominal"].failure == pytest.approx(-math.expm1(-0.3), rel=1e-14)
    assert [one.path for one in found.report.deciding] == ["b", "a"]
    free = assess(monitor.plant, monitor.exposure, monitor.ledger, task)  # the design wants nothing
    assert (free.limit, free.longest_prefix, free.go) == (0.0, 30, True)


def test_the_designs_limit_is_taken_unless_there_is_another_and_must_be_a_probability() -> None:
    monitor = Monitor(parse(DESIGN))
    assert assess(monitor.plant, monitor.exposure, monitor.ledger, TASK).limit == 0.9
    for limit in (-0.1, 1.1, math.nan):
        with pytest.raises(RobophmError, match="limit"):
            assess(monitor.plant, monitor.exposure, monitor.ledger, TASK, limit=limit)
