"""A robot of one part with a temperature, for the tests here."""

from __future__ import annotations

import json
from typing import Any

import pytest

from robophm.design.file import parse
from robophm.design.robot import Robot


def robot(**design: Any) -> Robot:
    components = {"part": {"rate": "0.01 /h", "acceleration": {"model": "q10"}}}
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **design}))


def bound(topic: str, field: str, **more: Any) -> dict[str, Any]:
    return {"signals": {"temperature": {"topic": topic, "field": field, **more}}}


def exact(value: Any) -> Any:
    return pytest.approx(float(value), rel=1e-12, abs=0)
