"""Small robots with a temperature, for the tests here and for those of the commands that are about them."""

from __future__ import annotations

import json
from typing import Any

import pytest

from robophm.core.signal import SECOND
from robophm.design.file import parse
from robophm.design.robot import Robot


def written(**design: Any) -> str:
    """The text of a design, of one part unless ``components`` are given."""
    components = {"part": {"rate": "0.01 /h", "acceleration": {"model": "q10"}}}
    return json.dumps({"schema_version": 1, "name": "R", "components": components, **design})


def robot(**design: Any) -> Robot:
    return parse(written(**design))


def bound(topic: str, field: str, **more: Any) -> dict[str, Any]:
    return {"signals": {"temperature": {"topic": topic, "field": field, **more}}}


def exact(value: Any) -> Any:
    return pytest.approx(float(value), rel=1e-12, abs=0)


IN_2038 = 2_147_483_000 * SECOND
"""Where a clock jumps that has lost its battery."""

WARM = {"acceleration": {"model": "q10", "reference_temperature": "25 degC"}}
MOTOR = {"motor": {"rate": "0.01 /h", **WARM}}
MEASURED = bound("/motor", "temperature", unit="degC", max_age="10 s", range=[-40, 125])
MEASURED_AS = "/motor.temperature"
