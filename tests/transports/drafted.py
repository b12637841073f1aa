"""What `robophm new --via` makes of a robot that runs, whichever way it is heard."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from robophm.cli import new
from robophm.cli.app import app
from robophm.design.file import parse

SECONDS = 4.0
"""To listen, which is enough on a busy machine where messages come twenty times a second."""


def drafted_of_a_robot_that_runs(
    via: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    environment: Mapping[str, str] = {},
) -> dict[str, Any]:
    """The draft as JSON: its motor is bound to the temperature that the robot publishes, 35 degC."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(new, "LISTENED", SECONDS)
    for name in ("ROS_MASTER_URI", "ROS_IP"):
        if name in environment:
            monkeypatch.setenv(name, environment[name])
    words = ["--via", via, "--part", "motor=brushless motor", "--where", "indoor robot", "--computer", "raspberry pi"]
    app(["new", "robot.yaml", *words, "--json"], standalone_mode=False)
    document = dict(json.loads(capsys.readouterr().out))
    assert "bldc_motor" in {part["entry"] for part in document["parts"]}
    (bound,) = (one for one in document["bound"] if one["input"] == "temperature")
    assert bound["part"] == "further parts/motor"
    assert bound["seen"].startswith("35 … 35 degC, ")
    (signal,) = bound["signals"]
    assert "temperature" in signal
    assert parse((folder / "robot.yaml").read_text()).signals
    return document
