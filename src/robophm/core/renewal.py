"""A thing that fails, is repaired or replaced, again and again: its alternating renewal process, from now on.

Let W(t) be the failures expected until t and V(t) the repairs. The first failure comes by the law F₁ of what stands
there now, each later one by the law F of a new one, that many hours after a repair; a repair takes an exponential time
of mean r: W(t) = F₁(t) + ∫ F(t − u) dV(u), and V′(t) = D(t)/r, where D(t) = W(t) + D(0) − V(t) is P(it is down at t).
Rausand and Høyland, System Reliability Theory (2nd ed.), section 7.3. Solved on a grid on which W is taken as straight
between points; what lies between the repair's and the life's scale is then exact, however short a repair is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

TOLERANCE = 1e-5
"""Tolerance of P(down), as a share of the highest."""

_STEPS = (256, 512, 1024, 2048, 4096)
"""Points of the grids, one after the other until two agree."""


class Law(NamedTuple):
    """When a thing fails: functions of times, shape (times,), that give P(failed) by then."""

    first: Callable[[Array], Array]
    """P(what stands there now fails by then)."""
    new: Callable[[Array], Array]
    """P(a new one fails by then)."""


class Renewals:
    """Several things that fail and are repaired side by side, each on a grid of its own until ``until``."""

    def __init__(self, laws: Sequence[Law], repair: Array, until: Array, down: npt.NDArray[np.bool_]) -> None:
        """Solve for things of these laws; ``repair``: mean time of one, infinite if there is none; shape (things,).

        ``until``: the time [unit of repair] from which on each is taken as settled; ``down``: whether each is down at
        first; shape (things,).
        """
        self._repair, self._begin, rough = repair, down, np.empty(0)
        for steps in _STEPS:
            self._step = until / steps
            self._failures = _failures(laws, repair, self._step, steps, down)
            self._frequency, self._bend = _frequency(self._failures, self._step)
            self._down = self._down_at_points()
            if len(rough):
                highest = np.maximum(self._down.max(axis=1), 1e-300)
                self.error = np.abs(self._down[:, ::2] - rough).max(axis=1) / highest / 3
                """About how far off P(down) is, as a share of the highest; shape (things,)."""
                if (self.error < TOLERANCE).all():
                    break
            rough = self._down

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return P(down) and the failures to be expected in an hour, at times of shape (times,); (things, times)."""
        steps = self._frequency.shape[1]
        where = np.clip(times / self._step[:, None], 0.0, steps * (1 - 1e-15))
        cell, rows = where.astype(np.intp), np.arange(len(self._step))[:, None]
        into = where - cell
        mean, bend = self._frequency[rows, cell], self._bend[rows, cell]
        down = _later(self._down[rows, cell], mean, bend, self._step[:, None], into, self._repair[:, None])
        down += self._begin[:, None] * np.exp(-times / self._repair[:, None])
        return np.clip(down, 0.0, 1.0), np.maximum(mean + bend * (into - 0.5), 0.0)

    def _down_at_points(self) -> Array:
        """P(down) at the points, of all but the first repair of what is down at first."""
        down = np.zeros_like(self._failures)
        whole = np.ones(len(down))
        for n in range(down.shape[1] - 1):
            mean, bend = self._frequency[:, n], self._bend[:, n]
            down[:, n + 1] = _later(down[:, n], mean, bend, self._step, whole, self._repair)
        return np.clip(down, 0.0, 1.0)


def _later(down: Array, mean: Array, bend: Array, step: Array, into: Array, repair: Array) -> Array:
    """P(down) ``into`` a step, from that at its begin: failures in an hour rise by ``bend`` over it, about their
    ``mean``."""
    passed = into * step
    share = passed / repair  # 0 where nothing is repaired
    repaired = np.isfinite(repair)
    lasting = np.where(repaired, repair, 0.0)
    built = np.where(repaired, -np.expm1(-share) * lasting, passed)  # down of a failure in each hour since the begin
    # The same of failures that rise by one in an hour from the begin on.
    rising = np.where(repaired, np.where(share > 1e-4, lasting * (passed - built), passed**2 * (0.5 - share / 6)),
                      passed**2 / 2)  # fmt: skip
    return down * np.exp(-share) + (mean - bend / 2) * built + bend / step * rising


def _frequency(failures: Array, step: Array) -> tuple[Array, Array]:
    """Failures in an hour: their mean over each step, and by how much they rise over it; shape (things, steps)."""
    slope = np.gradient(failures, axis=1, edge_order=2) / step[:, None]
    mean = np.diff(failures, axis=1) / step[:, None]
    return mean, np.clip(np.diff(slope, axis=1), -2 * mean, 2 * mean)


def _after_repair(law: Law, times: Array, repair: float) -> Array:
    """P(failed again) of what is being repaired at first; shape of ``times``."""
    if math.isinf(repair):
        return np.zeros(len(times))
    nodes, weights = np.polynomial.legendre.leggauss(24)
    repaired = -np.expm1(-times / repair)[:, None]
    share = repaired * (1 + nodes) / 2  # of repairs, by when they end
    new = times[:, None] + repair * np.log1p(-share)
    failed = law.new(np.maximum(new, 0.0).ravel()).reshape(new.shape)
    found: Array = (repaired * failed) @ weights / 2
    return found


def _failures(laws: Sequence[Law], repair: Array, step: Array, steps: int, begin: npt.NDArray[np.bool_]) -> Array:
    """W at the points of a grid; shape (things, steps + 1). Between them it goes straight here, which will do for V."""
    points = np.arange(2 * steps + 1) * step[:, None] / 2
    first = np.array([_after_repair(law, own[::2], mean) if down else law.first(own[::2])
                      for law, own, mean, down in zip(laws, points, repair, begin, strict=True)])  # fmt: skip
    new = np.array([law.new(own) for law, own in zip(laws, points, strict=True)])
    mean = (new[:, :-2:2] + 4 * new[:, 1::2] + new[:, 2::2]) / 6  # of the law of a new one, over each step
    held = np.exp(-step / repair)
    share = np.where(np.isfinite(repair), (1 - held) * np.where(np.isfinite(repair), repair, 0.0) / step, 1.0)
    repaired = np.zeros((len(step), steps))  # in each step
    failures, down = first.copy(), np.zeros(len(step))
    failures[:, 0] = 0.0
    backwards = mean[:, ::-1]
    for n in range(1, steps + 1):
        before = np.einsum("ij,ij->i", backwards[:, steps - n : steps - 1], repaired[:, : n - 1])
        due = down * (1 - held)  # repairs of what was down
        more = first[:, n] + before - failures[:, n - 1] + mean[:, 0] * due
        more = np.maximum(more / (1 - mean[:, 0] * (1 - share)), 0.0)
        repaired[:, n - 1] = due + more * (1 - share)
        failures[:, n] = failures[:, n - 1] + more
        down = down * held + more * share
    return failures


def constant(rate: Array, repair: Array, down: npt.NDArray[np.bool_], times: Array) -> tuple[Array, Array]:
    """Return P(down) and failures in an hour of things of constant rate, at times; shape (things, times).

    ``rate`` [1/h], ``repair`` [h] and whether each is ``down`` at first have shape (things,). Rausand and Høyland,
    equation 7.24, for things that work at first.
    """
    restored = 1 / repair
    pace = rate + restored
    settled = np.divide(rate, pace, out=np.zeros_like(pace), where=pace > 0)[:, None]
    left = np.exp(-pace[:, None] * times)
    grown = settled * -np.expm1(-pace[:, None] * times)
    found = np.where(down[:, None], settled + (1 - settled) * left, grown)
    return found, rate[:, None] * (1 - found)
