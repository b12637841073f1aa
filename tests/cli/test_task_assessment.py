"""What a robot that asks is told is what ``robophm task`` prints."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.task_assessor import TaskAssessor
from robophm.stores.sqlite import SqliteStore

from .conftest import Run

T0 = 1_700_000_000 * SECOND
DESIGN = """
schema_version: 1
name: R
signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 600 s}}
components:
  left: {rate: 0.3 /h, uncertainty: {error_factor: 3}, acceleration: {model: q10, reference_temperature: 25 degC}}
  right: {rate: 0.2 /h}
  lamp: {rate: 0.05 /h, life: {distribution: weibull, shape: 2}}
functions:
  drive: {parallel: [left, right]}
  see: lamp
"""
TASK = Task((Leg(0.5, 100.0, functions=("drive",)), Leg(0.25, 50.0, functions=("see",)), Leg(1.0, 10.0)))


def test_of_the_same_past_every_figure_is_the_same(tmp_path: Path, inside: Run) -> None:
    """A used robot whose rates are uncertain and whose motor ran hot, to 1e-12."""
    (tmp_path / "robot.yaml").write_text(DESIGN)
    robot = parse(DESIGN)
    monitor = Monitor(robot)
    for second in range(0, 40_000, 300):  # eleven hours, from which loads to come are drawn
        monitor.observe(Sample(T0 + second * SECOND, "/motor.temperature", 40.0 + second % 7))
    settled = monitor.exposure.settled(monitor.ledger)
    with SqliteStore(tmp_path / "past.db") as store:
        store.save(robot.identity, settled.to_json())
    legs = [{"duration": f"{leg.duration} h", "distance": f"{leg.distance} m", "functions": list(leg.functions)}
            for leg in TASK.legs]  # fmt: skip
    (tmp_path / "tasks.yaml").write_text(json.dumps({"schema_version": 1, "tasks": [{"legs": legs}]}))
    printed = inside("task", "robot.yaml", "tasks.yaml", "--store", "past.db", "--draws", "500", "--json")
    assert printed.returncode == 0, printed.stderr
    said = json.loads(printed.stdout)
    assessor = TaskAssessor(robot)
    assessor.see(settled, ())
    answer = assessor.assess(TASK)
    found = answer.report
    for view in ("nominal", "sensor_based"):
        for name in ("probability", "failure"):
            assert getattr(found.together[view], name) == pytest.approx(said["together"][view][name], rel=1e-12)
    assert said["uncertainty"]["failure"] != said["uncertainty"]["failure_if_load_known"]
    assert answer.failure is not None
    assert [*answer.failure] == pytest.approx([*said["uncertainty"]["failure"].values()], rel=1e-12)
    assert found.together["sensor_based"].failure > 1.05 * found.together["nominal"].failure
    assert [one.path for one in found.deciding] == [one["path"] for one in said["deciding"]]
    assert [one.share for one in found.deciding] == pytest.approx([one["share"] for one in said["deciding"]], rel=1e-12)
