"""Reliability diagram and PIT histogram as SVG."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robophm.report.curve import log_ticks, tick_texts, ticks
from robophm.report.frame import HEIGHT, SIZE, WIDTH, frame
from robophm.report.markup import Html, element, number
from robophm.report.svg import svg
from robophm.report.words import number_text

if TYPE_CHECKING:
    from robophm.calibration.lives import LifeScore
    from robophm.calibration.tasks import Bin

Array = NDArray[np.float64]

_STYLE = (
    f".calibration text{{font-size:{SIZE:g}px;fill:var(--quiet)}}"
    ".calibration .title{font-size:13px;font-weight:600;fill:var(--ink)}"
    ".calibration .axis,.calibration .grid{fill:none;stroke:var(--line)}.calibration .grid{stroke-opacity:.3}"
    ".calibration .honest{fill:none;stroke:var(--ink);stroke-dasharray:5 4}"
    ".calibration .band{fill:var(--line);fill-opacity:.35}"
    ".calibration .bar{fill:var(--c0);fill-opacity:.75}.calibration .inside{fill:var(--c0)}"
    ".calibration .outside{fill:var(--error)}.calibration .none{fill:var(--paper);stroke:var(--c0);stroke-width:1.6}"
    ".calibration .none.outside{stroke:var(--error)}"
    ".calibration .middle{text-anchor:middle}.calibration .right{text-anchor:end}"
)
_NEAR_ZERO = 0.05  # the smallest predicted probability below which decades say more


def reliability_svg(bins: Sequence[Bin], *, title: str, standalone: bool = False) -> Html:
    """Observed over predicted probability of failure, with the band of each bin; logarithmic where some are small.

    A diamond lies outside its band; a hollow mark on the lower edge is a bin without any failure.
    """
    predicted = np.array([one.expected / one.tasks for one in bins])
    observed = np.array([one.failed / one.tasks for one in bins])
    bands = np.array([[k / one.tasks for k in one.band] for one in bins])
    everything = np.concatenate([predicted, observed, bands.ravel()])
    positive = everything[everything > 0]
    decades = positive.size > 0 and float(predicted[predicted > 0].min(initial=1.0)) < _NEAR_ZERO
    if decades:
        low, high = math.log10(positive.min()) - 0.15, min(0.02, math.log10(positive.max()) + 0.1)
        marks = log_ticks(low, high)[0]
        says = [number_text(float(mark)) for mark in 10**marks]
    else:
        low, high = 0.0, min(1.0, 1.05 * float(everything.max(initial=0.0))) or 1.0
        marks = ticks(low, high)
        says = tick_texts(marks)[0]

    def place(share: Array) -> Array:
        if not decades:
            return share
        with np.errstate(divide="ignore"):
            return np.maximum(np.log10(share), low)

    span = (low, high)
    x_at, y_at, axes = frame(title, span, span, (marks, says), (marks, says), "observed share of failures",
                               "predicted probability of failure")  # fmt: skip
    drawn = [element("path", class_="honest", d=_line(x_at(low), y_at(low), x_at(high), y_at(high)))]
    columns = zip(bins, x_at(place(predicted)), y_at(place(observed)), y_at(place(bands)), strict=True)
    words = []
    for one, x, y, (bottom, top) in columns:
        kind = ("none " if decades and not one.failed else "") + ("outside" if one.outside else "inside")
        drawn.append(element("rect", class_="band", x=x - 5, y=top - 1, width=10, height=bottom - top + 2, rx=2))
        drawn.append(
            element("path", class_=kind, d=f"M{number(x)} {number(y - 6)}l6 6l-6 6l-6 -6Z")
            if one.outside
            else element("circle", class_=kind, cx=x, cy=y, r=4)
        )
        words.append(
            f"Predicted {number_text(one.expected / one.tasks)}, observed {number_text(one.failed / one.tasks)}"
            + (", outside its band." if one.outside else ".")
        )
    return _drawing(title, " ".join(words), [*axes, *drawn], standalone)


def histogram_svg(score: LifeScore, *, title: str, standalone: bool = False) -> Html:
    """A histogram of the predicted probabilities at which lives ended: level where predictions are honest."""
    heights = np.array(score.histogram, dtype=float)
    top = 1.15 * max(heights.max(), score.band[1])
    y_ticks = ticks(0, top)
    x_ticks = ticks(0, 1)
    x_at, y_at, axes = frame(
        title, (0, 1), (0, top), (x_ticks, tick_texts(x_ticks)[0]), (y_ticks, tick_texts(y_ticks)[0]), "lives",
        "predicted probability of a life no longer than the observed one (PIT)",
    )  # fmt: skip
    edges = x_at(np.linspace(0, 1, heights.size + 1))
    even = float(y_at(score.lives / heights.size))
    low, high = (float(y_at(k)) for k in score.band)
    drawn = []
    for left, right, count in zip(edges, edges[1:], score.histogram, strict=False):
        y = float(y_at(count))
        drawn.append(element("rect", class_="bar outside" if score.outside(count) else "bar", x=left + 1, y=y,
                             width=right - left - 2, height=float(y_at(0)) - y))  # fmt: skip
    drawn.append(element("rect", class_="band", x=edges[0], y=high, width=edges[-1] - edges[0], height=low - high))
    drawn.append(element("path", class_="honest", d=_line(edges[0], even, edges[-1], even)))
    words = f"{', '.join(map(str, score.histogram))} lives; honest between {score.band[0]} and {score.band[1]}."
    return _drawing(title, words, [*axes, *drawn], standalone)


def _line(x0: float | Array, y0: float | Array, x1: float | Array, y1: float | Array) -> str:
    return f"M{number(float(x0))} {number(float(y0))}L{number(float(x1))} {number(float(y1))}"


def _drawing(title: str, words: str, content: list[Html], standalone: bool) -> Html:
    view = (0.0, 0.0, WIDTH, HEIGHT)
    return svg("calibration", content, title=title, description=words, style=_STYLE, view=view, standalone=standalone)
