"""A frame with two axes, its marks where they are said to be: for scales of every kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from robophm.report.markup import Html, element, number, text_width
from robophm.report.svg import text

Array = NDArray[np.float64]

SIZE = 11.0
"""Size of the font [px]."""
WIDTH, HEIGHT = 460.0, 380.0

Place = Callable[[Array | float], Array]


def frame(
    title: str,
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    x_ticks: tuple[Array, Sequence[str]],
    y_ticks: tuple[Array, Sequence[str]],
    y_label: str,
    x_label: str,
) -> tuple[Place, Place, list[Html]]:
    """The axes of a plot, and the functions that place values in it [px]."""
    left = 12 + max((text_width(says, SIZE) for says in y_ticks[1]), default=0)
    right, top, bottom = WIDTH - 14, 48.0, HEIGHT - 40

    def scale(low: float, high: float, start: float, stop: float) -> Place:
        return lambda at: start + (np.asarray(at, dtype=float) - low) / (high - low) * (stop - start)

    x_at, y_at = scale(*x_range, left, right), scale(*y_range, bottom, top)
    grid = "".join(f"M{number(left)} {number(y)}H{number(right)}" for y in y_at(y_ticks[0]))
    marks = "".join(f"M{number(x)} {number(bottom)}v4" for x in x_at(x_ticks[0]))
    return (
        x_at,
        y_at,
        [
            text(2, 14, title, "title"),
            text(2, 34, y_label),
            element("path", class_="grid", d=grid),
            element("path", class_="axis", d=f"M{number(left)} {number(top)}V{number(bottom)}H{number(right)}{marks}"),
            *(text(left - 6, y + 4, says, "right") for y, says in zip(y_at(y_ticks[0]), y_ticks[1], strict=True)),
            *(text(x, bottom + 17, says, "middle") for x, says in zip(x_at(x_ticks[0]), x_ticks[1], strict=True)),
            text((left + right) / 2, HEIGHT - 6, x_label, "middle"),
        ],
    )
