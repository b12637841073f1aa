"""What the tests of prognosis share."""

from __future__ import annotations

import json
from typing import Any

import pytest

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.health.mission import Completion
from robophm.health.prognosis import RemainingLife
from robophm.health.subject import Figures


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def exact(value: Any, rel: float = 1e-12) -> Any:
    return pytest.approx(float(value), rel=rel, abs=0)


def hours(duration: float) -> Task:
    return Task.plain(0.0, duration)


def life(found: Figures) -> RemainingLife:
    assert found.remaining_life
    return found.remaining_life


def task(found: Figures) -> Completion:
    assert found.completion
    return found.completion
