"""Answers as pictures: ``robophm.plot``, by matplotlib."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from robophm.core.argument_checks import shown
from robophm.core.errors import RobophmError
from robophm.health.importance import Importances
from robophm.health.report import VIEWS, HealthReport
from robophm.health.what_matters import WhatMatters
from robophm.interface.asking import of_extra
from robophm.learning.life_data.distribution_fitting import Fit

MOST_BARS = 20
"""Parts that a picture of importances has."""


def plot(answer: Any, axes: Any = None) -> Any:
    """Draw a report's survival from now on, importances as bars, or a fit's failures; returns the axes.

    ``axes`` of matplotlib to draw in, else new ones. Raises RobophmError for what is none of these, PlugError where
    matplotlib is not installed.
    """
    if isinstance(answer, Sequence) and not isinstance(answer, str) and answer and isinstance(answer[0], Fit):
        answer = answer[0]
    if isinstance(answer, WhatMatters):
        answer = answer.importances["sensor_based"]
    if not isinstance(answer, HealthReport | Importances | Fit):
        raise RobophmError(f"{shown(answer)} cannot be drawn; expected a report, importances or a fit")
    if axes is None:
        axes = of_extra("matplotlib.pyplot", "a plot").subplots(layout="constrained")[1]
    if isinstance(answer, HealthReport):
        _survival(answer, axes)
    elif isinstance(answer, Importances):
        _bars(answer, axes)
    else:
        _fit(answer, axes)
    return axes


def _survival(report: HealthReport, axes: Any) -> None:
    lives = [report.remaining_life(view) for view in VIEWS]
    ends = [one.late for one in lives if 0 < one.late < math.inf]
    hours = np.linspace(0.0, max(ends, default=1.0), 200)
    for view in VIEWS:
        outlook = report.outlooks[view]
        _, survives = outlook.curve(outlook.plant.robot.diagram)(hours)
        axes.plot(hours, survives, "-" if view == "nominal" else "--", label=view.replace("_", "-"))
    left_out = report.system.unknown
    more = f"\n{left_out.sentence}" if left_out else ""
    axes.set(
        title=f"{report.robot}: survival, given that it works now{more}", xlabel="calendar time from now [h]",
        ylabel="probability to work on", ylim=(0, 1.02),
    )  # fmt: skip
    axes.legend()


def _bars(found: Importances, axes: Any) -> None:
    some = [one for one in found.ranked() if not math.isnan(one.criticality)][:MOST_BARS][::-1]
    axes.barh([one.unit for one in some], [one.criticality for one in some])
    axes.set(title=f"Criticality importance within {found.hours:g} h of operation", xlabel="share")


def _fit(found: Fit, axes: Any) -> None:
    unit = f" [{found.data.unit}]" if found.data.unit else ""
    axes.plot(found.plot.times, found.plot.failed, "o", label="failures (median ranks)")
    if len(found.plot.times):
        times = np.linspace(0.0, 1.2 * float(found.plot.times.max()), 200)[1:]
        axes.plot(times, found.life.failure_probability(times), label=f"{found.name} fit")
    axes.set(title=found.data.described(), xlabel=f"life{unit}", ylabel="share that has failed")
    axes.legend()
