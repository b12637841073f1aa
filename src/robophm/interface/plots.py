"""Answers as pictures: ``robophm.plot``, by matplotlib."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from robophm.calibration.score import Calibration
from robophm.core.argument_checks import shown
from robophm.core.errors import RobophmError
from robophm.health.importance import Importances
from robophm.health.report import VIEWS, HealthReport
from robophm.health.what_matters import WhatMatters
from robophm.interface.asking import of_extra
from robophm.interface.wear import Wear
from robophm.learning.life_data.distribution_fitting import Fit

MOST_BARS = 20
"""Parts that a picture of importances has."""


def plot(answer: Any, axes: Any = None) -> Any:
    """Draw an answer; returns the axes.

    Of a report its survival from now on; of importances bars; of a fit its failures; of wear each part's readings, its
    threshold and when that is reached; of judged predictions what failed over what was expected to. ``axes`` of
    matplotlib to draw in, else new ones. Raises RobophmError for what is none of these, PlugError where matplotlib is
    not installed.
    """
    if isinstance(answer, Sequence) and not isinstance(answer, str) and answer and isinstance(answer[0], Fit):
        answer = answer[0]
    if isinstance(answer, WhatMatters):
        answer = answer.importances["sensor_based"]
    draw = next((one for kind, one in _DRAWN.items() if isinstance(answer, kind)), None)
    if draw is None:
        raise RobophmError(
            f"{shown(answer)} cannot be drawn; expected a report, importances, a fit, wear or judged predictions"
        )
    if axes is None:
        axes = of_extra("matplotlib.pyplot", "a plot").subplots(layout="constrained")[1]
    draw(answer, axes)
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


def _wear(found: Wear, axes: Any) -> None:
    """Readings by time, and where the threshold is reached: the median, and between 5 and 95 %."""
    for i, one in enumerate(found.modes):
        times, foretold, colour = one.readings.times, one.wear, f"C{i}"
        axes.plot(times, one.values, ".", color=colour, label=one.mode.path)
        axes.axhline(foretold.signal_threshold, linestyle="--", color=colour)
        left = foretold.remaining
        if len(times) and math.isfinite(left.median):
            axes.axvline(times[-1] + left.median, linestyle=":", color=colour)
            axes.axvspan(times[-1] + left.low, times[-1] + min(left.high, 10 * left.median), color=colour, alpha=0.15)
    units = " or ".join(dict.fromkeys(one.unit for one in found.modes))
    axes.set(title=f"{found.robot.name}: wear, and when it reaches its threshold", xlabel=f"time [{units}]")
    axes.legend()


def _reliability_diagram(found: Calibration, axes: Any) -> None:
    """What failed over what was expected, with the numbers that leave a prediction credible as bars."""
    scored = [one for one in found.models if one.tasks is not None]
    if not scored:
        raise RobophmError("predictions of lives alone have no diagram of tasks; expected some of tasks")
    for model in scored:
        bins = model.tasks.bins if model.tasks else ()
        said, seen = ([getattr(one, name) / one.tasks for one in bins] for name in ("expected", "failed"))
        low, high = ([one.band[end] / one.tasks for one in bins] for end in (0, 1))
        axes.vlines(said, low, high, color="0.8", linewidth=6)
        axes.plot(said, seen, "o", label=model.model)
    axes.axline((0, 0), slope=1, color="0.5", linestyle="--")
    axes.set(
        title="Did as many fail as were expected to?", xlabel="expected share that fails", ylabel="share that failed"
    )
    axes.legend()


_DRAWN: Mapping[type, Callable[[Any, Any], None]] = {
    HealthReport: _survival, Importances: _bars, Fit: _fit, Wear: _wear, Calibration: _reliability_diagram,
}  # fmt: skip
