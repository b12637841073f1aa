"""A span of the past, as ``--from`` and ``--to`` state it, and the course of a figure over it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from robophm.cli.shared.options import moment_of
from robophm.core.errors import RobophmError
from robophm.report.curve import sparkline
from robophm.report.words import number_text

Array = NDArray[np.float64]

COURSE = ("course", "lowest", "highest", "last")
"""Columns of what ``course_of`` returns."""


def span_of(start: str | None, end: str | None) -> tuple[int | None, int | None]:
    """Return the times [ns since the epoch] that are stated, None being open. Raises RobophmError."""
    first, last = (None if text is None else moment_of(name, text) for name, text in (("--from", start), ("--to", end)))
    if first is not None and last is not None and first >= last:
        raise RobophmError(f"--to {end}: expected a time after --from {start}")
    return first, last


def course_of(low: Array, mean: Array, high: Array, says: Callable[[float], str] = number_text) -> list[str] | None:
    """Return a figure's course as a line of text, its lowest, highest and last value; None where it has none.

    NaN is where it is not known; shape (times,) each. ``says``: how a value reads.
    """
    known = mean[~np.isnan(mean)]
    if not len(known):
        return None
    return [sparkline(mean, 30), *map(says, (np.nanmin(low), np.nanmax(high), known[-1]))]
