"""Health reports as far as a fleet looks into them, without what makes true ones."""

from __future__ import annotations

from typing import Any

MINUTE = 60 * 10**9
BEGIN = 1_700_000_000 * 10**9


def report(minute: int, chance: float = 0.01, **more: Any) -> dict[str, Any]:
    """A health report as JSON, as far as a fleet looks into it."""
    view = {
        "hazard_rate": 1e-4, "unreliability": 1e-3 * minute, "remaining_life": {"median": 5000.0 - minute},
        "completion": {"failure": 2e-5},
    }  # fmt: skip
    ahead = [
        {"horizon": hours, "sensor_based_failure": chance * hours / 168, "first": "motor", "share": 0.5, "bound": None}
        for hours in (24.0, 168.0, 720.0)
    ]
    return {
        "robot": "courier", "design_hash": "d1", "time": BEGIN + minute * MINUTE, "clocks": {"operating": minute / 60},
        "subjects": [{"nominal": view, "sensor_based": view}], "state": "ok", "failure_within": ahead, **more,
    }  # fmt: skip
