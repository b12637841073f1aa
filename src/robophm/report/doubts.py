"""Signals that may not be true, drawn: what each said over time, and what would fit in its place."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from robophm.core.signal import HOUR
from robophm.health.doubtful_signals import Doubt
from robophm.report.curve import Line, curve_svg
from robophm.report.markup import Html
from robophm.report.page import figure, side_by_side


def doubts_drawn(doubts: Sequence[Doubt]) -> Iterable[Html]:
    """Return a figure for each doubtful signal, side by side: the means of its past, and the value that would fit.

    One that has no past yet, in the first hour, is not drawn.
    """
    drawn = [_drawn(one) for one in doubts if len(one.about.ends)]
    if drawn:
        yield side_by_side(*drawn)


def _drawn(doubt: Doubt) -> Html:
    about = doubt.about
    hours = (about.ends - about.ends[-1]) / HOUR
    lines = [Line("what it said", hours, about.means)]
    if about.instead is not None:
        lines.append(Line("what would fit now", hours[[0, -1]], np.full(2, about.instead), dashed=True))
    drawn = curve_svg(
        lines, title=about.signal, x_label="time before its last reading [h]", y_label=about.unit or "value"
    )
    dashed = ", the dashed line" if about.instead is not None else ""
    return figure(drawn, f"{about.signal} {about.why}; {about.otherwise}{dashed}")
