"""Load shared by equal parts that age, of which at most one may fail: exactly, by cumulative exposure.

All survivors have the same age, because they began with one and have borne the same load since. Of n parts the first
fails at τ with density n·h·exp(−n·H), having aged ``factors[0]`` times as fast as the path; from then on the others
age ``factors[1]`` times as fast (Nelson, "Accelerated testing" (1990), chapter 10: the age is what carries over).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robophm.blocks.diagram import LoadSharing
from robophm.core.errors import StructureError
from robophm.groups.member import Member, Mode, alike, log_rate
from robophm.groups.path import Array, Path, Rows
from robophm.groups.quadrature import log_integral, log_sum
from robophm.groups.solved_group import SolvedGroup, log_fails, log_outlives


class SharedLoad(SolvedGroup):
    """A load-sharing group along a path; ``status`` at ``now`` of each member: True works, False has failed, None."""

    def __init__(
        self, group: LoadSharing, members: Sequence[Member], path: Path, now: float, status: Sequence[bool | None]
    ) -> None:
        self.now, self.told = now, any(one is not None for one in status)
        self._n, self._factors, self._path, self._member = len(members), group.factors, path, members[0]
        if not alike(members, path):
            raise StructureError(
                f"{group.name}: parts that age and share a load have no exact solution once they differ in age or "
                "stress; expected equal ones, or an estimate by simulation"
            )
        works, failed = (sum(one is said for one in status) for said in (True, False))
        # Where nobody has failed by now, and how many of those who may be the one who has.
        self._whole = failed == 0
        self._may = self._n - works if failed == 0 else int(failed == 1)

    def _hazard(self, s: Array, length: Array, then: Array | None = None) -> Array:
        """Cumulative hazard of one part: all work until s, one has failed since; or of the stretch ``then`` then."""
        ages, gained = self._path.at(s), self._path.between(s, length)
        more = None if then is None else self._path.between(s + length, then)
        total = np.zeros(np.broadcast(s, length).shape)
        for mode in self._member:
            i, (slow, fast) = mode.column, self._speeds(mode)
            age = mode.age + slow * ages[i]
            if more is None:
                total = total + mode.multiplicity * mode.life.increment(age, fast * gained[i])
            else:
                total = total + mode.multiplicity * mode.life.increment(age + fast * gained[i], fast * more[i])
        return total

    def _whole_hazard(self, s: Array, length: Array | None = None) -> Array:
        """Cumulative hazard of one part while all work, until s; or of the stretch after it."""
        ages = self._path.at(s)
        more = None if length is None else self._path.between(s, length)
        total = np.zeros(np.shape(s))
        for mode in self._member:
            i, (slow, _) = mode.column, self._speeds(mode)
            if more is None:
                total = total + mode.multiplicity * mode.life.increment(mode.age, slow * ages[i])
            else:
                total = total + mode.multiplicity * mode.life.increment(mode.age + slow * ages[i], slow * more[i])
        return total

    def _speeds(self, mode: Mode) -> tuple[float, float]:
        """How much faster than the path a mode ages while all work, and once one has failed."""
        return (1.0, 1.0) if mode.always else (self._factors[0], self._factors[1])

    def _log_rate(self, s: Array, length: Array, lost: int) -> Array:
        """ln of one part's hazard rate, all having worked until s, per unit of s, ``length`` later, so many lost."""
        ages, gained = self._path.at(s), self._path.between(s, length)
        piece = self._path.piece(s + length)
        ageing = []
        for mode in self._member:
            i, (slow, fast) = mode.column, self._speeds(mode)
            age = mode.age + slow * ages[i] + fast * gained[i]
            ageing.append((mode, age, (slow, fast)[lost] * self._path.speed[piece, i]))
        return log_rate(ageing)

    def _first(self, s: Array, until: Array) -> Array:
        """ln of the density with which the first part fails at s, of those that may have if that is before now."""
        n, lived = self._n, self._whole_hazard(s)
        with np.errstate(divide="ignore"):
            count = np.log(np.where((s < self.now) & (until >= self.now), self._may, n if self._whole else 0))
        return count + self._log_rate(s, np.zeros_like(s), 0) + log_outlives(n * lived)

    def log_works(self, s: Array) -> Array:
        """ln P(works at s, and what is known), shape (times,)."""

        def one_failed(which: Rows, since: Array, length: Array) -> Array:
            return self._first(since, s[which]) + log_outlives((self._n - 1) * self._hazard(since, length))

        whole = log_outlives(self._n * self._whole_hazard(s))
        whole = whole if self._whole else np.where(s >= self.now, -np.inf, whole)
        return log_sum(whole, log_integral(one_failed, np.zeros(len(s)), s, self._breaks))

    def log_fails_in(self, s: Array, length: Array) -> Array:
        """ln P(works at s, fails in the stretch after it, and what is known)."""

        def later(which: Rows, since: Array, lived: Array) -> Array:
            before = log_outlives((self._n - 1) * self._hazard(since, lived))
            more = log_fails((self._n - 1) * self._hazard(since, lived, length[which]))
            return self._first(since, s[which]) + before + more

        def soon(which: Rows, since: Array, rest: Array) -> Array:
            return self._first(since, since) + log_fails((self._n - 1) * self._hazard(since, rest))

        return log_sum(
            log_integral(later, np.zeros(len(s)), s, self._breaks), log_integral(soon, s, s + length, self._breaks)
        )

    def log_density(self, s: Array) -> Array:
        """ln of the failure density at s, and what is known; per unit of s."""

        def second(which: Rows, since: Array, length: Array) -> Array:
            lived = log_outlives((self._n - 1) * self._hazard(since, length))
            rate = self._log_rate(since, length, 1)
            return self._first(since, s[which]) + lived + rate + float(np.log(self._n - 1))

        return log_integral(second, np.zeros(len(s)), s, self._breaks)

    @property
    def _breaks(self) -> list[float]:
        return sorted({*self._path.corners[1:].tolist(), *([self.now] if self.told else [])})
