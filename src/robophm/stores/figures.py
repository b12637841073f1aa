"""The figures of a robot's reports that are kept for ever, and their lowest, mean and highest over spans of time."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

VIEWS = ("nominal", "sensor_based")

STATES = ("ok", "warn", "stale", "error")
"""States of a robot, the worst last; as a figure each is its place in this row."""

FIGURES = (
    *(
        f"{name}.{view}"
        for name in ("hazard_rate", "unreliability", "remaining_life", "task_failure")
        for view in VIEWS
    ),
    "operating",
    "state",
)
"""Names of the figures, in the order of every array of them: hazard rate [1/h of operation], probability of having
failed since new, median remaining life [h of calendar time] and probability of failing the task in both views; hours
of operation since the start; the state's place in STATES."""

Array = npt.NDArray[np.float64]
Single = np.dtype("<f4")
Count = np.dtype("<u4")


class FigureSeries(NamedTuple):
    """The figures over time: lowest, mean and highest of the reports in each of some spans of time."""

    width: int
    """Length of a span [ns]; 0 where each is one report."""
    times: npt.NDArray[np.int64]
    """Beginning of each span, or time of each report [ns since the epoch], ascending; shape (n,)."""
    number: npt.NDArray[np.int64]
    """Number of reports in each span that have the figure; shape (n, figures), as the next three."""
    low: Array
    mean: Array
    """Mean of the reports; NaN, as the others, where none has the figure."""
    high: Array

    def of(self, name: str) -> tuple[Array, Array, Array]:
        """Return lowest, mean and highest of a figure by its name; shape (n,) each."""
        at = FIGURES.index(name)
        return self.low[:, at], self.mean[:, at], self.high[:, at]

    @property
    def broken(self) -> npt.NDArray[np.intp]:
        """Places before which no line is to be drawn: for more than three usual steps there was no report."""
        steps = np.diff(self.times)
        return np.flatnonzero(steps > 3 * np.median(steps)) + 1 if len(steps) else np.empty(0, dtype=np.intp)

    def to_json(self) -> dict[str, Any]:
        """Return the series as plain values: None where there is no value, the text "Infinity" where it is infinite.

        Where each point is one report there are no ``low`` and ``high``, which are the ``mean``.
        """
        parts = {"low": self.low, "mean": self.mean, "high": self.high} if self.width else {"mean": self.mean}
        return {
            "width": self.width,
            "times": self.times.tolist(),
            "figures": {
                name: {part: _plain(values[:, i]) for part, values in parts.items()} for i, name in enumerate(FIGURES)
            },
        }


def _plain(values: Array) -> list[float | str | None]:
    finite = np.isfinite(values).all()
    return values.tolist() if finite else [_one(value) for value in values.tolist()]


def _one(value: float) -> float | str | None:
    return None if math.isnan(value) else value if math.isfinite(value) else "Infinity"


def figures_of(report: Mapping[str, Any]) -> list[float]:
    """Return the figures of a health report as JSON; NaN where it has none."""
    system = (report.get("subjects") or [{}])[0]
    state = report.get("state")
    return [
        *(value for figure in _SYSTEM for value in (_number(system.get(view, {}), figure) for view in VIEWS)),
        _number(report, ("clocks", "operating")),
        float(STATES.index(state)) if state in STATES else math.nan,
    ]


MOST_SIGNALS = 64
"""The most signals of one report whose courses are kept, those that the design names first."""


def signals_in(reports: Iterable[Mapping[str, Any]]) -> dict[str, dict[int, list[float]]]:
    """Return the values of signals in health reports as JSON, by name and time [ns], each as a row of one figure."""
    found: dict[str, dict[int, list[float]]] = {}
    for report in reports:
        for signal, value in islice(report.get("signals", {}).items(), MOST_SIGNALS):
            found.setdefault(signal, {})[report["time"]] = [float(value)]
    return found


_SYSTEM = (("hazard_rate",), ("unreliability",), ("remaining_life", "median"), ("completion", "failure"))


def _number(found: Any, path: tuple[str, ...]) -> float:
    for step in path:
        found = found.get(step) if found else None
    return math.nan if found is None else float(found)


def packed(series: FigureSeries) -> list[bytes]:
    """Return each row of a series as bytes, to be kept: single precision, seven digits."""
    if not series.width:
        return [row.tobytes() for row in series.mean.astype(Single)]
    values = np.concatenate([series.low, series.mean, series.high], axis=1).astype(Single)
    return [row.tobytes() + count.tobytes() for row, count in zip(values, series.number.astype(Count), strict=True)]


def unpacked(width: int, times: list[int], rows: list[bytes], n_figures: int = len(FIGURES)) -> FigureSeries:
    """Return the series of rows that were kept, each of so many figures."""
    n = len(rows)
    at = np.array(times, dtype=np.int64)
    if not width:
        values = np.frombuffer(b"".join(rows), Single).reshape(n, n_figures).astype(float)
        return FigureSeries(0, at, (~np.isnan(values)).astype(np.int64), values, values, values)
    kept = np.dtype([("values", Single, (3, n_figures)), ("count", Count, (n_figures,))])
    found = np.frombuffer(b"".join(rows), kept)
    low, mean, high = (found["values"][:, i].astype(float) for i in range(3))
    return FigureSeries(width, at, found["count"].astype(np.int64), low, mean, high)


def joined(series: FigureSeries, width: int) -> FigureSeries:
    """Return a series over longer spans of time, which begin at the multiples of their width [ns]."""
    spans = series.times // width
    if not len(spans):
        return series._replace(width=width)
    first = np.flatnonzero(np.diff(spans, prepend=spans[0] - 1))
    number = np.add.reduceat(series.number, first)
    with np.errstate(invalid="ignore", divide="ignore"):  # of what is infinite, or has no value
        sums = np.add.reduceat(np.where(series.number > 0, series.mean * series.number, 0.0), first)
        mean = np.where(number > 0, sums / number, np.nan)
    return FigureSeries(
        width, spans[first] * width, number, np.fmin.reduceat(series.low, first), mean,
        np.fmax.reduceat(series.high, first),
    )  # fmt: skip
