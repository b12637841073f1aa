"""What topics say of a robot with a part of unknown rate: never plainly OK, never zero for what is not known."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.health.mission import Completion
from robophm.health.report import HealthReport
from robophm.health.unknown_rates import unknown_in_parts
from robophm.monitoring.monitor import Monitor
from robophm.transports.health_topics.definitions import typestore
from robophm.transports.health_topics.message_of_fields import compose
from robophm.transports.health_topics.report_fields import (
    diagnostics,
    hazard_rates,
    health,
    markers,
    reliabilities,
    task_completion,
    task_completions,
)  # fmt: skip
from robophm.transports.signals.report_sink import JudgedTask

WARN, STALE = 1, 3


def report(wiring: Any, *, silent: bool = False) -> HealthReport:
    """Of a robot with a module whose one of two parts is of unknown rate, and one that is known."""
    warm: dict[str, Any] = {"rate": "1e-4 /h", "initial_exposure": "1000 h"}
    if silent:
        warm["acceleration"] = {"model": "q10", "reference_temperature": "40 degC"}
    drive: dict[str, Any] = {"components": {"motor": warm, "board": {"rate": "unknown"}}, "diagram": wiring}
    if silent:
        drive["signals"] = {"temperature": {"topic": "/t", "field": "data", "unit": "degC"}}
    light = {"components": {"lamp": {"rate": "1e-5 /h", "initial_exposure": "1000 h"}}}
    monitor = Monitor(parse(json.dumps({
        "schema_version": 1, "name": "R", "modules": {"Drive": drive, "Light": light}, "task": {"duration": "1 h"},
    })))  # fmt: skip
    if silent:
        for second in range(0, 300, 5):
            monitor.observe(Sample((1_700_000_000 + second) * SECOND, "/odom", 1.0))
    return monitor.report(parts=True)


FACES = [  # how it is wired; what the hazard rate, and remaining life and completion, of its module are
    ({"series": ["motor", "board"]}, "at least", "at most", 1e-4),
    ({"parallel": ["motor", "board"]}, "if they never fail", "if they never fail", math.nan),
]


@pytest.mark.parametrize(("wiring", "rate", "ahead", "module_rate"), FACES)
def test_all_topics(wiring: Any, rate: str, ahead: str, module_rate: float) -> None:
    found = report(wiring)
    said = {one["name"]: one for one in diagnostics(found, "node")["status"]}
    for name, level in (("node: R", WARN), ("node: Drive", WARN), ("node: Light", 0)):
        assert said[name]["level"] == level
    drive = said["node: Drive"]
    assert "1 part of unknown rate is left out of the totals" in drive["message"]
    assert drive["message"].count("unknown rate") == 1
    values = {one["key"]: one["value"] for one in drive["values"]}
    assert (values["parts of unknown rate"], values["reliabilities are"]) == ("1", "at most")
    assert (values["hazard rates are"], values["remaining lives and completions are"]) == (rate, ahead)
    assert said["node: Light"]["message"] == "OK"
    assert "parts of unknown rate" not in {one["key"] for one in said["node: Light"]["values"]}

    rates, survival = hazard_rates(found), reliabilities(found)
    assert rates["module_names"] == ["Drive", "Light"]
    for key in ("module_values", "module_sensor_based_values"):
        assert rates[key] == pytest.approx([module_rate, 1e-5], nan_ok=True)
        whole = [math.exp(-0.1) if rate == "at least" else math.nan, math.exp(-0.01)]
        assert survival[key] == pytest.approx(whole, nan_ok=True)
    part = {one.path: health(found, one) for one in (*found.subjects, *found.components)}
    assert [part[path]["state"] for path in ("R", "Drive", "Drive/board", "Drive/motor", "Light")] == [1, 1, 1, 0, 0]
    for name, value in part["Drive/board"].items():
        assert not name.endswith(("nominal", "sensor_based")) or math.isnan(value), name
    assert part["Drive/motor"]["hazard_rate_nominal"] == pytest.approx(1e-4)

    texts = [one["text"] for one in markers(found, "base_link")["markers"] if one["text"]]
    shown = {text.partition(":")[0]: text for text in texts}
    assert shown["Drive"] == ("Drive: WARN, λ ≥ 0.0001/h" if rate == "at least" else "Drive: WARN, λ unknown")
    assert shown["Light"] == "Light: OK, λ 1e-05/h"
    for generation, type_, fields in (
        (1, "phm_msgs/msg/HazardRate", rates), (2, "diagnostic_msgs/msg/DiagnosticArray", diagnostics(found, "node")),
        (1, "phm_msgs/msg/Health", part["Drive/board"]),
    ):  # fmt: skip
        assert compose(typestore(generation), type_, fields)  # type: ignore[arg-type]


def test_a_silent_sensor_comes_before_what_nobody_knows_and_both_are_said() -> None:
    found = report({"series": ["motor", "board"]}, silent=True)
    drive = next(one for one in diagnostics(found, "node")["status"] if one["name"] == "node: Drive")
    assert drive["level"] == STALE
    assert "stale /t.data" in drive["message"]
    assert "1 part of unknown rate is left out of the totals" in drive["message"]


def test_a_task_that_hangs_on_them() -> None:
    sure = {"nominal": Completion(1.0, 0.0), "sensor_based": Completion(0.9, 0.1)}
    left_out = unknown_in_parts(report({"series": ["motor", "board"]}).outlooks["nominal"].plant.components)
    for unknown in (None, left_out):
        task = JudgedTask(True, 0, "/t", 1.0, 2.0, sure, unknown)
        flat, old = task_completion(task), task_completions(0, task, None)["actual_potc"]
        assert (flat["completion_sensor_based"], old["potc_sensor_based_value"]) == (0.9, 0.9)
        for value in (flat["completion_nominal"], old["potc_nominal_value"]):
            assert math.isnan(value) == bool(unknown)
