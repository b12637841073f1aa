"""Curves of a robot's figures so far, from the series that its store gives."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from robophm.core.signal import HOUR
from robophm.report.curve import Line, curve_svg
from robophm.report.markup import Html
from robophm.report.page import figure
from robophm.report.words import moment_text
from robophm.stores.figures import FigureSeries

VIEWS = {"nominal": "nominal", "sensor_based": "sensor-based"}
"""The two views and what they are called."""

CURVES = {
    "hazard_rate": ("Hazard rate", "λ [1/h of operation]"),
    "unreliability": ("Probability of having failed since new", "1 − R"),
    "remaining_life": ("Remaining life, median", "RUL [h]"),
    "task_failure": ("Probability of failing the task", "1 − PoTC"),
}
"""Figures by name, with the title and the label of their curves."""


def past_curves(robot: str, series: FigureSeries, names: tuple[str, ...] = tuple(CURVES)) -> Iterator[Html]:
    """Yield a plot of each of these figures that is known; no line is drawn across a time when the robot was off.

    Lines are means; where a point is more than one report, the lowest and highest of the sensor-based are drawn too.
    """
    if len(series.times) < 2:
        return
    hours = (series.times - series.times[0]) / HOUR
    since = moment_text(int(series.times[0]))[:16] + " UTC"
    off = series.broken
    for name in names:
        lines = []
        for view, words in VIEWS.items():
            low, mean, high = series.of(f"{name}.{view}")
            drawn = {words: mean}
            if series.width and view == "sensor_based":
                drawn |= {f"{words}, lowest": low, f"{words}, highest": high}
            for label, values in drawn.items():
                known = np.where(np.isfinite(values), values, np.nan)
                x, y = np.insert(hours, off, hours[off - 1]), np.insert(known, off, np.nan)
                lines.append(Line(label, x, y, dashed=view == "sensor_based"))
        if all(np.isnan(np.asarray(line.y)).all() for line in lines):
            continue
        title, label = CURVES[name]
        yield figure(
            curve_svg(lines, title=title, x_label=f"hours since {since}", y_label=label),
            f"{title} of {robot}, as recorded",
        )
