"""The probability that a robot fails within each of some times ahead, and what its failure would most likely be of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from robophm.health.failures_to_come import failures_to_come
from robophm.health.report import HealthReport


def failure_within(report: HealthReport, horizons: Sequence[float]) -> list[dict[str, Any]]:
    """Return, for each horizon [h of calendar time], what ``failures_to_come`` says of it, as plain values for JSON.

    ``first`` is the part, or group, of which most of those failures would come, and ``share`` how much of them; None
    where there is none. ``bound`` says how the figures stand to the true ones, where parts of unknown rate are left
    out. Raises RobophmError as that.
    """
    found = [failures_to_come(report.outlooks, report.design.diagram, one, one) for one in horizons]
    return [
        {
            "horizon": one.horizon,
            "operating": one.operating,
            "nominal_failure": one.nominal_failure,
            "sensor_based_failure": one.sensor_based_failure,
            "first": one.contributions[0].path if one.contributions else None,
            "share": one.contributions[0].sensor_based if one.contributions else None,
            "bound": one.unknown.failing if one.unknown else None,
        }
        for one in found
    ]
