"""Failures that a robot's figures promised over a stretch of its history, against those that were noted.

The cumulative hazard that a robot goes through until it fails is exponential with mean 1, whatever its hazard (time
change of a counting process: D. R. Cox and D. Oakes, *Analysis of Survival Data*, 1984, §6). So of a robot whose
failures are repaired, those within a stretch are as many as of a Poisson process over the cumulative hazard of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import pdtr, pdtrc

from robophm.stores.figures import FigureSeries

LEVEL = 0.05
"""The chance at which a count of failures speaks against what was promised, from both sides together."""

MOST_FAILED = 0.9999
"""A probability of having failed since new above which seven digits of it do not tell a cumulative hazard any more."""

_ROUNDING = 1e-6


def promised_failures(series: FigureSeries, services: Sequence[int], view: str) -> float | None:
    """Return the mean number of failures that figures promised: the cumulative hazard gone through, between services.

    ``services``: times at which parts were served [ns], when the probability of having failed falls; what passes from
    the report before one to the report after it is left out. ``view``: ``nominal`` or ``sensor_based``. None where
    there are no two reports, or the figures do not tell: they are beyond ``MOST_FAILED``, or were revised downwards
    without a service, as a forecast of wear may be.
    """
    failed = series.of(f"unreliability.{view}")[1]
    served = np.sort(np.asarray(services, dtype=np.int64))
    before = np.searchsorted(served, series.times, side="left")
    clear = np.isfinite(failed) & (before == np.searchsorted(served, series.times + series.width, side="right"))
    failed, before = failed[clear], before[clear]
    if len(failed) < 2 or failed.max() > MOST_FAILED:
        return None
    gone = -np.log1p(-failed)
    first = np.flatnonzero(np.diff(before, prepend=-1))
    last = np.append(first[1:], len(gone)) - 1
    steps, within = np.diff(gone), np.diff(before) == 0
    if (steps[within] < -_ROUNDING * (1 + gone[1:][within])).any():
        return None
    return float((gone[last] - gone[first]).sum())


@dataclass(frozen=True)
class CountedFailures:
    """Failures that were noted, against the mean number that was promised."""

    promised: float
    noted: int

    @property
    def chance(self) -> float:
        """Return the chance of a count as far off as this, both ways together, if the promise was right."""
        least = pdtrc(self.noted - 1, self.promised) if self.noted else 1.0
        return float(min(1.0, 2 * min(least, pdtr(self.noted, self.promised))))

    @property
    def against(self) -> tuple[int | None, int]:
        """Return the counts that speak against the promise: so many or fewer, None where none does, and so many or
        more."""
        many = 1
        while pdtrc(many - 1, self.promised) >= LEVEL / 2:
            many += 1
        few = -1
        while pdtr(few + 1, self.promised) < LEVEL / 2:
            few += 1
        return (few if few >= 0 else None), many

    @property
    def says(self) -> str:
        """Return the verdict in a sentence."""
        few, many = self.against
        counted = f"{self.promised:.2g} promised, {self.noted or 'none'} noted"
        if self.chance < LEVEL:
            kind = "more" if self.noted > self.promised else "fewer"
            return (
                f"What was promised does not hold: {counted}, {kind} than chance explains ({100 * self.chance:.2g} %)"
            )
        low = "" if few is None else "none, or " if few == 0 else f"{few} or fewer, or "
        seen = f"{low}{many} or more"
        return f"Nothing speaks against what was promised: {counted}; {seen} would speak against it"
