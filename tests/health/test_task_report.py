"""The report of a list of tasks: closed forms, what decides, thresholds, and what JSON is told."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Plan, Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger, Step
from robophm.health.plant import Plant
from robophm.health.task_report import SCHEMA_VERSION, TaskReport, task_report

A, B, C = 1e-2, 2e-2, 5e-3
PARTS = {name: {"rate": f"{rate} /h"} for name, rate in (("a", A), ("b", B), ("c", C))}
FUNCTIONS = {"drive": {"series": ["a", "c"]}, "see": {"parallel": ["b", "c"]}}
FIRST = Task((Leg(2.0, functions=("drive",)),), "fetch")
SECOND = Task((Leg(3.0, functions=("drive",)), Leg(4.0, functions=("see",))), "look")
AGE = 10.0


def robot(**more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": PARTS, "functions": FUNCTIONS, **more}))


def lived(design: Robot, factor: float = 1.0, steps: int = 1) -> Ledger:
    """AGE hours, in which sensors saw so many times the design's stress."""
    ledger, n = Ledger.new(design), len(design.modes)
    ledger.age.add(np.full(n, AGE))
    ledger.effective.add(np.full(n, factor * AGE))
    hours = AGE / steps
    ledger.history = [
        Step(i, hours, hours, np.full(n, hours), np.full(n, (2 * factor if i % 2 else 0.5 * factor) * hours), {})
        for i in range(steps)
    ]
    return ledger


def report(design: Robot, *tasks: Task, ledger: Ledger | None = None, **options: Any) -> TaskReport:
    knowledge = options.pop("knowledge", Knowledge())
    ledger = ledger or lived(design)
    return task_report(Plant(design), ExposureIntegrator(design), ledger, Plan(tasks, knowledge), **options)


def exact(value: float) -> Any:
    return pytest.approx(value, rel=1e-12, abs=0)


def test_each_task_given_those_before_and_all_together() -> None:
    """c is needed to drive and known to work; b beside it is not known, and has aged."""
    found = report(robot(), FIRST, SECOND)
    first, second = found.tasks
    drive = math.exp(-(A + C) * 2)
    assert first.nominal.probability == exact(drive)
    c_fails_late = -math.expm1(-C * 4)  # after the last drive, 5 h from now
    b_failed = -math.expm1(-B * (AGE + 9))
    together = math.exp(-(A + C) * 5) * (1 - c_fails_late * b_failed)
    assert found.together["nominal"].probability == exact(together)
    # The second asks that seeing works as the first is done: c does, as it drove.
    assert first.nominal.probability * second.nominal.probability == exact(together)
    for one in (first, second):
        assert one.nominal == one.sensor_based
        assert one.nominal.failure == exact(1 - one.nominal.probability)
    assert [one.task.name for one in found.tasks] == ["fetch", "look"]
    assert (found.robot, found.uncertainty, found.threshold, found.breached) == ("R", None, None, False)


def test_what_decides() -> None:
    found = report(robot(), FIRST, SECOND).deciding
    together = report(robot(), FIRST, SECOND).together["sensor_based"].failure
    b_failed, c_late = -math.expm1(-B * (AGE + 9)), -math.expm1(-C * 4)
    without = {
        "a": 1 - math.exp(-C * 5) * (1 - c_late * b_failed),
        "b": 1 - math.exp(-(A + C) * 5),
        "c": 1 - math.exp(-A * 5),
    }
    assert [one.path for one in found] == sorted(without, key=lambda path: without[path])
    for one in found:
        assert one.failure_without == exact(without[one.path])
        assert one.share == pytest.approx((together - without[one.path]) / together, rel=1e-9)


@pytest.mark.parametrize(("wanted", "breached"), [(0.97, False), (0.98, True)])
def test_the_threshold_is_of_each_task_as_sensors_have_it(wanted: float, breached: bool) -> None:
    """exp(−0.015·2) = 0.9704: fetching is enough, all that is beyond is breached."""
    found = report(robot(thresholds={"completion": wanted}), FIRST)
    assert (found.threshold, found.breached) == (wanted, breached)
    assert report(robot(thresholds={"completion": 0.97}), FIRST, SECOND).breached


def test_knowledge_of_the_plan() -> None:
    broken = report(robot(), FIRST, SECOND, knowledge=Knowledge(failed=frozenset("b")))
    assert broken.together["nominal"].probability == exact(math.exp(-(A + C) * 5 - C * 4))
    lame = report(robot(), FIRST, knowledge=Knowledge(failed=frozenset("a")))
    assert (lame.tasks[0].nominal.probability, lame.tasks[0].nominal.failure) == (0.0, 1.0)


def test_uncertainty_is_told_where_there_is_some() -> None:
    gamma = {"uncertainty": {"failures": 2}}
    certain, unsure = robot(), robot(**gamma)
    assert report(certain, FIRST).uncertainty is None
    assert report(unsure, FIRST, draws=0).uncertainty is None
    rates = report(unsure, FIRST, draws=20_000).uncertainty
    assert rates
    expected = 1.0
    for rate in (A, C):  # known to work, AGE hours old: Lomax
        expected *= ((2 / rate + AGE) / (2 / rate + AGE + 2)) ** 2
    assert rates.mean.probability == pytest.approx(expected, rel=1e-4)
    assert rates.failure == rates.failure_if_load_known
    loads = report(certain, FIRST, ledger=lived(certain, 2.0, 16)).uncertainty
    assert loads  # of a past in steps of 0.625 h at once and four times the stress, in turns
    assert loads.failure.low < loads.failure.high
    assert loads.failure == loads.failure_if_rates_known
    assert loads.failure_if_load_known.low == exact(loads.failure_if_load_known.high)


def test_the_seed_decides_the_draws() -> None:
    design = robot(uncertainty={"error_factor": 3})
    one, same, other = (report(design, FIRST, draws=200, seed=seed).uncertainty for seed in (1, 1, 2))
    assert one == same != other


def test_json_tells_it_all() -> None:
    design = robot(uncertainty={"error_factor": 3}, thresholds={"completion": 0.9})
    found = report(design, FIRST, SECOND, ledger=lived(design, 2.0, 16), draws=500)
    told = json.loads(json.dumps(found.to_json(), allow_nan=False))
    assert set(told) == {
        "schema_version", "robot", "tasks", "together", "uncertainty", "deciding", "threshold", "wear",
    }  # fmt: skip
    assert (told["schema_version"], told["robot"], told["threshold"]) == (SCHEMA_VERSION, "R", 0.9)
    assert [one["name"] for one in told["tasks"]] == ["fetch", "look"]
    assert [(one["duration"], one["distance"], len(one["legs"])) for one in told["tasks"]] == [(2, 0, 1), (7, 0, 2)]
    assert told["tasks"][1]["legs"][1]["functions"] == ["see"]
    for one, figures in zip(told["tasks"], found.tasks, strict=True):
        for view in ("nominal", "sensor_based"):
            completion = getattr(figures, view)
            assert one[view] == {"probability": completion.probability, "failure": completion.failure}
    for view, completion in found.together.items():
        assert told["together"][view] == {"probability": completion.probability, "failure": completion.failure}
    assert found.uncertainty
    assert told["uncertainty"]["mean"]["failure"] == found.uncertainty.mean.failure
    for name in ("failure", "failure_if_rates_known", "failure_if_load_known"):
        assert told["uncertainty"][name] == dict(
            zip(("low", "median", "high"), getattr(found.uncertainty, name), strict=True)
        )
    assert [(one["path"], one["failure_without"], one["share"]) for one in told["deciding"]] == [
        (one.path, one.failure_without, one.share) for one in found.deciding
    ]


def test_nothing_to_do_is_done() -> None:
    design = robot(uncertainty={"error_factor": 3}, thresholds={"completion": 0.9999})
    for tasks in ((), (Task(()),), (Task(()), Task(()))):
        found = report(design, *tasks)
        assert [one.sensor_based.probability for one in found.tasks] == [1.0] * len(tasks)
        assert found.together["sensor_based"].failure == 0.0
        assert (found.deciding, found.breached) == ((), False)
        json.dumps(found.to_json(), allow_nan=False)
