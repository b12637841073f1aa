"""Parts of any life of which each is needed: what is left of a group that can lose no more."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np

from robophm.groups.member import Member, log_density, working_hazard
from robophm.groups.path import Array, Path
from robophm.groups.solved_group import SolvedGroup, log_fails, log_outlives


class SeriesOfParts(SolvedGroup):
    """A series of parts along a path; what bears the load ages ``factor`` times as fast as the path."""

    def __init__(self, factor: float, members: Sequence[Member], path: Path) -> None:
        self.now, self.told = 0.0, False
        self._modes = [mode for member in members for mode in member]
        faster = np.full(path.speed.shape[1], factor)
        faster[[mode.column for mode in self._modes if mode.always]] = 1.0
        self._path = copy(path)
        self._path.speed, self._path.gained = path.speed * faster, path.gained * faster

    def _more(self, s: Array, length: Array) -> Array:
        """Cumulative hazard that a stretch adds."""
        return working_hazard(self._modes, self._path, np.zeros_like(s), s, 1.0, length)

    def log_works(self, s: Array) -> Array:
        """ln P(works at s, and what is known), shape (times,)."""
        return log_outlives(working_hazard(self._modes, self._path, np.zeros_like(s), s, 1.0))

    def log_fails_in(self, s: Array, length: Array) -> Array:
        """ln P(works at s, fails in the stretch after it, and what is known)."""
        return self.log_works(s) + log_fails(self._more(s, length))

    def log_stays(self, s: Array, length: Array, works: Array) -> Array:
        """ln P(works at the end of the stretch | works at s)."""
        return log_outlives(self._more(s, length))

    def log_density(self, s: Array) -> Array:
        """ln of the failure density at s, and what is known; per unit of s."""
        return log_density(self._modes, self._path, np.zeros_like(s), s, s, 1.0)
