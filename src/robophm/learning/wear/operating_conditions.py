"""Signals as they would be at one operating condition: less what settings explain, regime by regime.

Where a setting leaves gaps (an altitude, a tool, a payload) it has regimes, and readings are compared within theirs
alone; within a regime a signal is taken to be linear in the settings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError

Array = npt.NDArray[np.float64]

GAP = 0.05
"""Share of a setting's range that no reading lies in, from which on there are regimes on its two sides."""

MOST_REGIMES = 50
FEWEST = 30
"""Readings of a regime, of all units together; what has fewer counts as of the nearest that has."""


@dataclass(frozen=True)
class OperatingConditions:
    """The usual values of signals under each setting, whatever the health, as learned from all readings."""

    cuts: tuple[Array, ...]
    """Bounds between the regimes of each setting, in the middle of its gaps."""
    regimes: Array
    """Numbers of the parts between cuts, of each regime; shape (regimes, settings)."""
    low: Array
    high: Array
    """How far settings reach in each regime, beyond which nothing is extrapolated; shapes of ``regimes``."""
    fits: Array
    """Constant and slopes by setting; shape (regimes, settings + 1, signals)."""
    spread: Array
    """Deviation of what is left; 0 of a signal that stands still; shape (regimes, signals)."""

    def normalised(self, values: Array, settings: Array) -> Array:
        """Deviations of signals that vary in every regime; shape (readings, signals that vary).

        A regime that was not seen counts as the nearest.
        """
        which = _nearest(_parts(settings, self.cuts), self.regimes)
        design = np.column_stack([np.ones(len(values)), np.clip(settings, self.low[which], self.high[which])])
        usual = np.einsum("rs,rsk->rk", design, self.fits[which])
        kept = (self.spread > 0).all(axis=0)
        result: Array = ((values - usual) / np.where(self.spread > 0, self.spread, 1.0)[which])[:, kept]
        return result


def learn_operating_conditions(values: Sequence[Array], settings: Sequence[Array]) -> OperatingConditions:
    """Learn them from units, each with values (readings, signals) and settings (readings, settings), which may be none.

    Settings of more than ``MOST_REGIMES`` regimes are taken to have none. Raises DataError where no signal varies.
    """
    x, s = np.concatenate(values), np.concatenate(settings)
    cuts = tuple(_gaps(column) for column in s.T)
    regimes, counts = np.unique(_parts(s, cuts), axis=0, return_counts=True)
    if len(regimes) > MOST_REGIMES or counts.max() < FEWEST:
        cuts, regimes = tuple(np.zeros(0) for _ in s.T), np.zeros((1, s.shape[1]))
    else:
        regimes = regimes[counts >= FEWEST]
    which = _nearest(_parts(s, cuts), regimes)
    reach, fits, spread = [], [], []
    for k in range(len(regimes)):
        here, beside = x[which == k], s[which == k]
        slopes = np.linalg.lstsq(beside - beside.mean(axis=0), here, rcond=None)[0]
        constant = here.mean(axis=0) - beside.mean(axis=0) @ slopes
        left = (here - constant - beside @ slopes).std(axis=0)
        reach.append((beside.min(axis=0), beside.max(axis=0)))
        fits.append(np.concatenate([constant[None], slopes]))
        spread.append(np.where(left > 1e-9 * np.maximum(np.abs(here).mean(axis=0), 1e-300), left, 0.0))
    low, high = (np.array(ends) for ends in zip(*reach, strict=True))
    found = OperatingConditions(cuts, regimes, low, high, np.array(fits), np.array(spread))
    if not (found.spread > 0).all(axis=0).any():
        raise DataError("no signal varies; expected one at least that shows wear")
    return found


def _gaps(setting: Array) -> Array:
    known = np.unique(setting)
    wide = np.flatnonzero(np.diff(known) > GAP * max(float(np.ptp(known)), 1e-300))
    result: Array = (known[wide] + known[wide + 1]) / 2
    return result


def _nearest(parts: Array, regimes: Array) -> npt.NDArray[np.intp]:
    result: npt.NDArray[np.intp] = np.argmin(np.abs(parts[:, None, :] - regimes).sum(axis=2), axis=1)
    return result


def _parts(settings: Array, cuts: Sequence[Array]) -> Array:
    """Between which cuts each setting lies; shape of ``settings``."""
    found = [np.searchsorted(cut, column) for cut, column in zip(cuts, settings.T, strict=True)]
    result: Array = np.column_stack(found).astype(float) if found else np.zeros((len(settings), 0))
    return result
