"""Failures on probability paper: a straight line where the distribution is right. As SVG, and as lines of text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robophm.report.curve import log_ticks, tick_texts, ticks
from robophm.report.frame import HEIGHT, SIZE, WIDTH, frame
from robophm.report.markup import Html, element, number
from robophm.report.svg import svg
from robophm.report.words import number_text

if TYPE_CHECKING:
    from robophm.learning.life_data.distribution_fitting import Fit

Array = NDArray[np.float64]

_SHARES = np.array([0.001, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 0.9, 0.95, 0.99, 0.999])
_STYLE = (
    f".probability text{{font-size:{SIZE:g}px;fill:var(--quiet)}}"
    ".probability .title{font-size:13px;font-weight:600;fill:var(--ink)}"
    ".probability .axis,.probability .grid{fill:none;stroke:var(--line)}.probability .grid{stroke-opacity:.3}"
    ".probability .fitted{fill:none;stroke:var(--c1);stroke-width:1.6}.probability .point{fill:var(--c0)}"
    ".probability .middle{text-anchor:middle}.probability .right{text-anchor:end}"
)
_WIDE, _HIGH = 64, 16


class _Paper:
    """The probability paper of a fit, which places times and shares."""

    def __init__(self, found: Fit) -> None:
        from robophm.learning.life_data.distribution_fitting import straight

        self.location = float(getattr(found.life, "location", 0.0)) if found.name == "weibull3" else 0.0
        self.straight = straight
        # A gamma has no paper of its own: it is drawn, as a curve, on that of a Weibull.
        self.name = "weibull" if found.name == "gamma" else found.name
        self.linear = self.name in ("exponential", "normal", "gumbel")
        times, failed = found.plot.times, found.plot.failed
        low = min(float(failed.min()) / 1.6, 0.1)
        high = max(1 - (1 - float(failed.max())) / 1.6, 0.5)
        shares = 1 / (1 + np.exp(-np.linspace(np.log(low / (1 - low)), np.log(high / (1 - high)), 60)))
        line = np.asarray(found.life.quantile(shares), dtype=float)
        inside = (line > self.location) & np.isfinite(line) if not self.linear else np.isfinite(line)
        self.points = self.at(times, failed)
        self.line = self.at(line[inside], shares[inside])
        both = [np.concatenate((a, b)) for a, b in zip(self.points, self.line, strict=True)]
        self.x, self.y = ((float(one.min()), float(one.max()) + 1e-12) for one in both)
        pad = 0.03 * (self.x[1] - self.x[0])
        self.x = (self.x[0] - pad, self.x[1] + pad)

    def at(self, times: Array, shares: Array) -> tuple[Array, Array]:
        return self.straight(self.name, times, shares, self.location)

    def share_marks(self) -> tuple[Array, list[str]]:
        y = self.at(np.ones(len(_SHARES)) + self.location, _SHARES)[1]
        inside = (y >= self.y[0]) & (y <= self.y[1])
        return y[inside], [f"{100 * share:g} %" for share in _SHARES[inside]]

    def time_marks(self) -> tuple[Array, list[str]]:
        if self.linear:
            marks = ticks(*self.x)
            return marks, tick_texts(marks)[0]
        decades = 1 / np.log(10)
        marks, _ = log_ticks(self.x[0] * decades, self.x[1] * decades)
        return marks / decades, [number_text(float(10**mark + self.location), 3) for mark in marks]


def probability_svg(found: Fit, *, title: str, standalone: bool = False) -> Html:
    """The failures of a fit and its line."""
    paper = _Paper(found)
    unit = f" [{found.data.unit}]" if found.data.unit else ""
    x_at, y_at, axes = frame(title, paper.x, paper.y, paper.time_marks(), paper.share_marks(), "failed", f"life{unit}")
    line = "L".join(f"{number(float(x))} {number(float(y))}" for x, y in zip(x_at(paper.line[0]), y_at(paper.line[1]),
                                                                            strict=True))  # fmt: skip
    drawn = [element("path", class_="fitted", d=f"M{line}")]
    for x, y in zip(x_at(paper.points[0]), y_at(paper.points[1]), strict=True):
        drawn.append(element("circle", class_="point", cx=float(x), cy=float(y), r=3.5))
    words = f"{len(paper.points[0])} times of failure from {number_text(float(found.plot.times.min()))} to "
    words += f"{number_text(float(found.plot.times.max()))}; R² {number_text(found.straightness, 3)}."
    return svg("probability", [*axes, *drawn], title=title, description=words, style=_STYLE,
               view=(0.0, 0.0, WIDTH, HEIGHT), standalone=standalone)  # fmt: skip


def probability_text(found: Fit) -> list[str]:
    """The probability plot as lines of text: o failures, · the fit."""
    paper = _Paper(found)
    grid = [[" "] * _WIDE for _ in range(_HIGH)]

    def place(x: Array, y: Array, letter: str) -> None:
        columns = np.rint((x - paper.x[0]) / (paper.x[1] - paper.x[0]) * (_WIDE - 1)).astype(int)
        rows = np.rint((y - paper.y[0]) / (paper.y[1] - paper.y[0]) * (_HIGH - 1)).astype(int)
        for column, row in zip(columns.tolist(), rows.tolist(), strict=True):
            grid[_HIGH - 1 - row][column] = letter

    x = np.linspace(paper.line[0].min(), paper.line[0].max(), 200)
    place(x, np.interp(x, *paper.line), "·")
    place(*paper.points, "o")
    labels = [""] * _HIGH
    for y, says in zip(*paper.share_marks(), strict=True):
        labels[_HIGH - 1 - round((y - paper.y[0]) / (paper.y[1] - paper.y[0]) * (_HIGH - 1))] = says
    lines = [f"{label:>7} │{''.join(row)}".rstrip() for label, row in zip(labels, grid, strict=True)]
    feet = [" "] * (_WIDE + 8)
    for x_mark, says in zip(*paper.time_marks(), strict=True):
        at = round((x_mark - paper.x[0]) / (paper.x[1] - paper.x[0]) * (_WIDE - 1)) - len(says) // 2
        if at >= 0 and all(letter == " " for letter in feet[max(at - 1, 0) : at + len(says) + 1]):
            feet[at : at + len(says)] = says
    return [*lines, " " * 8 + "└" + "─" * _WIDE, " " * 9 + "".join(feet).rstrip()]
