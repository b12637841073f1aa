"""The interface of a solved group along its path, on what each way of solving it provides."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import numpy.typing as npt

from robophm.groups.path import Array
from robophm.groups.table import FARTHEST
from robophm.life.distribution import FAINT


class SolvedGroup(ABC):
    """A group solved along a path. Times are the path's; ``now`` is when what is known of the members is known."""

    now: float
    told: bool
    """Whether anything is known of a member."""

    @abstractmethod
    def log_works(self, s: Array) -> Array:
        """Return ln P(works at s, and what is known), shape (times,)."""

    @abstractmethod
    def log_fails_in(self, s: Array, length: Array) -> Array:
        """ln P(works at s, fails in the stretch after it, and what is known); no corner lies within."""

    def log_stays(self, s: Array, length: Array, works: Array) -> Array:
        """ln P(works at the end of the stretch after s | ``works`` at s, ln of its P); no corner lies within."""
        return self.log_works(s + length) - works

    @abstractmethod
    def log_density(self, s: Array) -> Array:
        """ln of the failure density at s, and what is known; per unit of s."""

    def lived(self, s: Array, length: Array) -> Array:
        """The cumulative hazard that a stretch adds to the group, given that it works when the stretch begins."""
        hazard = np.where(length > 0, np.inf, 0.0)
        todo = (length > 0) & ~self.over(s, length)
        if todo.any():
            hazard[todo] = self.gathered(s[todo], length[todo])
        return hazard

    def gathered(self, s: Array, length: Array) -> Array:
        """The cumulative hazard that a stretch adds, however large; infinite beyond FARTHEST."""
        works = self.log_works(s)
        works = np.where(works < -FARTHEST, -np.inf, works)
        with np.errstate(invalid="ignore"):
            fails = np.exp(np.minimum(self.log_fails_in(s, length) - works, 0.0))
        hazard = np.zeros(len(s))
        small = (fails < 0.5) & (works > -np.inf)
        hazard[small] = -np.log1p(-fails[small])
        large = ~small & (works > -np.inf)
        if large.any():
            hazard[large] = -self.log_stays(s[large], length[large], works[large])
        hazard[works == -np.inf] = np.inf
        return np.maximum(hazard, 0.0)

    def over(self, s: Array, length: Array) -> npt.NDArray[np.bool_]:
        """Return where no group that works at s outlives the stretch, but one of exp(1000)."""
        return np.zeros(len(s), dtype=bool)

    def rate(self, s: Array) -> Array:
        """Return the hazard rate at s, per unit of s."""
        works = self.log_works(s)
        with np.errstate(invalid="ignore", over="ignore"):
            rate: Array = np.where(works > -np.inf, np.exp(self.log_density(s) - works), np.inf)
        return rate


def log_fails(hazard: Array) -> Array:
    """ln(1 − exp(−H)); −inf of an H with hardly any digits left."""
    hazard = np.where(hazard < FAINT, 0.0, hazard)
    with np.errstate(divide="ignore"):
        found: Array = np.where(hazard < 0.6931, np.log(-np.expm1(-hazard)), np.log1p(-np.exp(-hazard)))
    return found


def log_outlives(hazard: Array) -> Array:
    """Return −H; −inf where that has no meaning but never."""
    return np.where(hazard > 1e100, -np.inf, -hazard)
