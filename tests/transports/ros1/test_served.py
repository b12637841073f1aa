"""The page's service beside a real roscore: a sensor is picked from live topics, and its part ages by it."""

from __future__ import annotations

from pathlib import Path

import pytest

from ...web.conftest import serving
from ..listener import within
from .conftest import System
from .test_watching import TALKER

DESIGN = """
schema_version: 1
name: R
components: {motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}}
"""


def test_a_live_topic_is_picked_bound_and_watched(ros: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROS_MASTER_URI", "ROS_IP"):
        monkeypatch.setenv(name, ros.environment[name])
    ros.talk(TALKER)
    (tmp_path / "robot.yaml").write_text(DESIGN)
    with serving(tmp_path / "robot.yaml") as served:
        topics = served.get("/api/topics", source="ros1")["topics"]
        motor = next(one for one in topics if one["topic"] == "/motor")
        assert {"field": "temperature", "unit": "degC", "last": None} in motor["fields"]
        binding = {"topic": "/motor", "field": "temperature", "unit": "degC", "range": [-40, 125], "max_age": "10 s"}
        served.edit({"op": "put", "path": ["signals", "temperature"], "value": binding})
        served.post("/api/monitoring/start", {"source": "ros1"})

        def rate() -> float:
            return float(served.get("/api/health")["subjects"][0]["sensor_based"]["hazard_rate"])

        within(20, lambda: served.get("/api/health")["samples"] > 20 and rate() == pytest.approx(0.02))  # 10 K warmer
        tested = served.post("/api/sensors/test", {"topic": "/motor", "field": "temperature"})
        assert tested["raw"] == 35.0
        assert served.post("/api/monitoring/stop")["state"] == "stopped"
