"""Whether promised failures came, as the service and the page tell it of a store."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from robophm.core.signal import DAY, HOUR, SECOND
from robophm.design.file import load
from robophm.health.ledger import Service
from robophm.monitoring.monitor import Monitor
from robophm.stores.sqlite import SqliteStore

from .conftest import SMALL, serving

BEGIN = 1_700_006_400 * SECOND
DAYS = 50
RATE = 1 / 400
"""Failures an hour that its reports promise."""


def fill(design: Path, path: Path, rate: float = RATE) -> None:
    """Keep 50 days in which the encoder failed four times, on one day of the last 30 and three before; a camera too."""
    robot = load(design)
    monitor = Monitor(robot)
    report = monitor.report(remaining_life="robot").to_json(failures_to_come=False)
    whole, rest = report["subjects"][0], report["subjects"][1:]
    served = [BEGIN + day * DAY + HOUR // 2 for day in (3, 6, 9, 40)]
    keys = {mode.path: mode.key for mode in robot.modes}
    gone, reports = 0.0, []
    for hour in range(24 * DAYS + 1):
        at = BEGIN + hour * HOUR
        gone = 0.0 if any(at - HOUR < one <= at for one in served) else gone + rate
        figures = {**whole["sensor_based"], "unreliability": -math.expm1(-gone)}
        reports.append({**report, "time": at, "subjects": [{**whole, "sensor_based": figures}, *rest]})
    none = (0.0, 0.0, 0.0)
    monitor.ledger.services[:] = [
        *(Service(at, keys["drive/encoder"], "replaced", True, none, none) for at in served),
        Service(served[0], keys["see/camera"], "replaced", True, none, none),
        Service(served[1], keys["drive/motor"], "repaired", False, none, none),
    ]
    with SqliteStore(path) as store:
        store.save(robot.identity, monitor.ledger.to_json(), (), reports)


def test_promised_and_noted_failures_of_a_store(tmp_path: Path) -> None:
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    fill(design, tmp_path / "past.db")
    with serving(design, seed=1, store=tmp_path / "past.db") as served:
        month, whole = (said := served.get("/api/history/honesty"))["spans"]
        assert said["of_others"] == 1  # of a camera beside a lidar
        assert (month["noted"], whole["noted"]) == (1, 4)
        assert month["promised"] == pytest.approx(720 * RATE, rel=0.02)
        assert whole["promised"] == pytest.approx(1200 * RATE, rel=0.02)
        assert whole["until"] == (BEGIN + DAYS * DAY) / SECOND
        assert month["until"] - month["since"] == pytest.approx(30 * 86_400, abs=3600)
        assert "1 noted" in month["says"]
        served.edit({"op": "put", "path": ["modules", "drive", "components", "encoder", "rate"], "value": "unknown"})
        assert served.get("/api/history/honesty")["spans"] == []
