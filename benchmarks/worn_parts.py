"""``python -m benchmarks.worn_parts``: forecasts of the parts of robots that wear, alone and with others as teachers.

Behind ``benchmarks.worn_honesty``: how many parts fail within a task, how many were promised to, how wide the forecasts
are, and how far their medians are off.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from benchmarks.worn_honesty import taught
from robophm.cli.shared.output import console
from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import Forecast
from robophm.simulation.worn_robots import LIMITS, WornRobot, worn_robots

NORMAL_90 = 3.29
"""Deviations of a normal distribution between its 5 % and its 95 % quantile."""


class Part(NamedTuple):
    """A forecast of one part in one robot, and what came."""

    said: bool
    promised: float
    """P(it fails within the task)."""
    failed: bool
    width: float
    """Deviation of ln(time to the threshold), by the 90 % interval; infinite of an open one."""
    off: float
    """ln(median / truth); not a number where the part never fails."""


def told(one: WornRobot, name: str, others: Sequence[Unit]) -> Part:
    values = one.readings[name]
    found: Forecast = forecast_among(others, np.arange(len(values)), values, LIMITS[name], draws=1000)
    rest = one.ends[name] - one.asked
    low, median, high = found.remaining
    return Part(
        found.said, float(np.mean(found.passage <= one.task)), rest <= one.task,
        math.log(high / low) / NORMAL_90 if low > 0 and math.isfinite(high) else math.inf,
        math.log(median / rest) if math.isfinite(rest) and median > 0 else math.nan,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.worn_parts", description="forecasts of parts alone")
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--teachers", type=int, default=10, help="others of a kind that wore out")
    parser.add_argument("--seed", type=int, default=2026)
    arguments = parser.parse_args()
    robots, out = worn_robots(arguments.robots, arguments.seed), console()
    out.print("part      teachers   said   promised   failed   deviation of ln(life)   median of ln(median / truth)")
    for name in LIMITS:
        for count in dict.fromkeys((0, arguments.teachers)):
            others = taught(count, arguments.seed + 1)[name]
            parts = [one for robot in robots if (one := told(robot, name, others)).said]
            out.print(
                f"{name:9} {count:8} {len(parts):6} {sum(one.promised for one in parts):10.1f} "
                f"{sum(one.failed for one in parts):8} {np.median([one.width for one in parts]):23.2f} "
                f"{np.nanmedian([one.off for one in parts]):30.2f}",
                highlight=False,
            )


if __name__ == "__main__":
    main()
