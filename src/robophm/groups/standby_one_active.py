"""Standby, one active at a time: members of any life, used in their order, exactly.

A spare that has not been used yet has aged as the path says, whatever happened to the others. So the density a(τ) with
which a member becomes the active one gives the density g(t) = ∫ a(τ)·f(t|τ)dτ with which it fails as such, and that
gives the density with which the next takes over. All are sums of positive terms, kept as logarithms.

Sources: the recursion is that of a sequence of lives, e.g. Barlow and Proschan, "Statistical theory of reliability and
life testing" (1975), chapter 6; what a switch and dormant failures do to it is spelled out below.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Standby
from robophm.groups.member import (
    Member,
    latest,
    log_density,
    log_waiting_fails,
    waiting_hazard,
    waiting_more,
    working_hazard,
)
from robophm.groups.path import Array, Path, Rows
from robophm.groups.quadrature import log_integral, log_sum
from robophm.groups.solved_group import SolvedGroup, log_fails, log_outlives
from robophm.groups.table import LogTable

_OVER = 1000.0  # a cumulative hazard that nothing outlives
_LOST = 1e-14
_PARTS = (0.0, 0.25, 0.5, 0.75, 1.0)


class OneActiveStandby(SolvedGroup):
    """A standby group with one active member along a path, from the path's start on.

    ``now``: the time up to which is known what ``status`` says: of each member True works, False has failed, None.
    """

    def __init__(
        self, group: Standby, members: Sequence[Member], path: Path, now: float, status: Sequence[bool | None]
    ) -> None:
        self._p, self._q = np.log(group.switch) if group.switch else -np.inf, group.switch
        self._dormancy, self._members, self._path, self._status = group.dormancy, members, path, tuple(status)
        self.now, self.told = now, any(one is not None for one in status)
        # Who may be the active one: before it nobody works.
        self._may = [one is not False and not any(before is True for before in status[:i])
                     for i, one in enumerate(status)]  # fmt: skip
        self.breaks = self._bends()
        """Times at which the densities may bend."""
        scale = self.scale() if len(members) > 2 else 1.0
        self._tables = {
            i: LogTable(partial(self._fails_directly, i), self.breaks, scale) for i in range(1, len(members) - 1)
        }

    def _bends(self) -> list[float]:
        """Times at which its densities may bend: also where a life with a location can end first."""
        found, called = {*self._path.corners[1:].tolist(), *([self.now] if self.told else [])}, 0.0
        for i, member in enumerate(self._members):
            first = math.inf
            for mode in member if called < math.inf else ():
                rest = max(getattr(mode.life, "location", 0.0) - mode.age, 0.0)
                wait = 1.0 if mode.always or not i else self._dormancy
                waited = float(self._path.at(np.array(called))[mode.column])
                end = self._path.when(mode.column, np.array(waited + max(rest - wait * waited, 0.0)))
                first = min(first, float(end))
                found |= {float(end), float(self._path.when(mode.column, np.array(rest / wait))) if wait else math.inf}
            called = min(called, first) if i else first
        return sorted(one for one in found if 0 < one < math.inf)

    def scale(self) -> float:
        """A time by which the first member has lived for a while."""
        s: Array = np.exp2(np.arange(-900.0, 900.0))
        with np.errstate(over="ignore"):  # where the clock is faster than time, as long as that is for ever
            lived = working_hazard(self._members[0], self._path, np.zeros_like(s), s, self._dormancy)
        return float(s[min(int(np.argmax(lived > 1)), len(s) - 1)])

    def over(self, s: Array, length: Array) -> npt.NDArray[np.bool_]:
        """Return where a member that works for its share of the stretch, new or used, cannot outlive it."""
        share = length / len(self._members)
        found = np.ones(len(s), dtype=bool)
        for member in self._members:
            for part in _PARTS:
                begin = s + (length - share) * part
                for since in (begin, s * part):
                    hazard = working_hazard(member, self._path, since, begin - since, self._dormancy, share)
                    found &= hazard > _OVER
        return found

    # Spares that wait: alive at s, dead at s, or either, consistent with what is known; logarithms.

    def _alive(self, i: int, s: Array) -> Array:
        lived = log_outlives(waiting_hazard(self._members[i], self._path, s, self._dormancy))
        return np.where(s >= self.now, -np.inf, lived) if self._status[i] is False else lived

    def _dead(self, i: int, s: Array) -> Array:
        if self._status[i] is False:
            return log_waiting_fails(self._members[i], self._path, np.minimum(s, self.now), self._dormancy)
        gone = log_fails(waiting_hazard(self._members[i], self._path, s, self._dormancy))
        if self._status[i] is None:
            return gone
        now = np.full(np.shape(s), self.now)
        by_now = waiting_hazard(self._members[i], self._path, now, self._dormancy)
        since = log_fails(
            waiting_more(self._members[i], self._path, now, np.maximum(s - self.now, 0.0), self._dormancy)
        )
        return np.where(s >= self.now, since - by_now, gone)

    def _either(self, i: int) -> float:
        if self._status[i] is None:
            return 0.0
        now = np.array([self.now])
        if self._status[i]:
            return -float(waiting_hazard(self._members[i], self._path, now, self._dormancy)[0])
        return float(log_waiting_fails(self._members[i], self._path, now, self._dormancy)[0])

    def _unused(self, i: int) -> float:
        """The logarithm of P(what is known of the spares behind a member)."""
        return sum(self._either(k) for k in range(i + 1, len(self._members))) if self.told else 0.0

    # Densities; logarithms, per unit of s.

    def fails(self, i: int, s: Array) -> Array:
        """Return ln of the density with which member i, as the active one, fails at s."""
        if i == 0:
            found = log_density(self._members[0], self._path, np.zeros_like(s), s, s, self._dormancy)
            return found if self._may[0] else np.where(s >= self.now, -np.inf, found)
        return self._tables[i](s) if i in self._tables else self._fails_directly(i, s)

    def _fails_directly(self, i: int, s: Array) -> Array:
        shape, s = np.shape(s), np.ravel(s)

        until = latest(self._members[i], self._path, s, self._dormancy)

        def log_f(which: Rows, since: Array, rest: Array) -> Array:
            length = rest + (s - until)[which]
            density = log_density(self._members[i], self._path, since, length, s[which], self._dormancy)
            return density + self._activated_until(i, since, s[which])

        with np.errstate(divide="ignore", invalid="ignore"):
            lost = _LOST * s / until  # by a difference of age and location
        return log_integral(log_f, np.zeros(len(s)), until, self.breaks, lost).reshape(shape)

    def _activated(self, i: int, s: Array) -> Array:
        """The logarithm of the density with which member i becomes the active one at s."""
        found = []
        for earlier in range(i):
            one = self.fails(earlier, s)
            for between in range(earlier + 1, i):
                one = one + self._dead(between, s)
            found.append(one)
        return self._p + log_sum(*found) + self._alive(i, s)

    def _activated_until(self, i: int, since: Array, s: Array) -> Array:
        """The same, of a member that is the active one until ``s``; who is now must be one who may be."""
        found = self._activated(i, since)
        return found if self._may[i] else np.where((since < self.now) & (s >= self.now), -np.inf, found)

    def _ends(self, i: int, s: Array) -> Array:
        """The logarithm of P(the group fails with member i: no switch, or nobody left; and what is known of the
        others).
        """
        later = range(i + 1, len(self._members))
        if not later:
            return np.zeros(np.shape(s))
        dead = self._p + sum((self._dead(k, s) for k in later), np.zeros(np.shape(s)))
        if self._q == 1:
            return dead
        return log_sum(dead, np.full(np.shape(s), np.log1p(-self._q) + self._unused(i)))

    # What others ask.

    def serves(self, i: int, s: Array) -> Array:
        """Return ln P(member i is the active one at s)."""
        if i == 0:
            first = log_outlives(working_hazard(self._members[0], self._path, np.zeros_like(s), s, self._dormancy))
            return first if self._may[0] else np.where(s >= self.now, -np.inf, first)

        def log_f(which: Rows, since: Array, length: Array) -> Array:
            lived = working_hazard(self._members[i], self._path, since, length, self._dormancy)
            return self._activated_until(i, since, s[which]) + log_outlives(lived)

        return log_integral(log_f, np.zeros(len(s)), s, self.breaks)

    def log_works(self, s: Array) -> Array:
        """ln P(works at s, and what is known)."""
        return log_sum(*(self.serves(i, s) + self._unused(i) for i in range(len(self._members))))

    def log_fails_in(self, s: Array, length: Array) -> Array:
        """ln P(fails in the stretch after s, and what is known): each member's last hour, once."""
        last = len(self._members) - 1
        found = []
        for i in range(last):

            def log_g(which: Rows, place: Array, rest: Array, i: int = i) -> Array:
                return self.fails(i, place) + self._ends(i, place)

            found.append(log_integral(log_g, s, s + length, self.breaks))

        def fails_later(which: Rows, since: Array, lived: Array) -> Array:
            before = working_hazard(self._members[last], self._path, since, lived, self._dormancy)
            more = working_hazard(self._members[last], self._path, since, lived, self._dormancy, length[which])
            return self._activated_until(last, since, s[which]) + log_outlives(before) + log_fails(more)

        def fails_soon(which: Rows, since: Array, rest: Array) -> Array:
            return self._activated(last, since) + log_fails(
                working_hazard(self._members[last], self._path, since, rest, self._dormancy)
            )

        found.append(log_integral(fails_later, np.zeros(len(s)), s, self.breaks))
        found.append(log_integral(fails_soon, s, s + length, self.breaks))
        return log_sum(*found)

    def log_density(self, s: Array) -> Array:
        """ln of the failure density at s, per unit of it."""
        return log_sum(*(self.fails(i, s) + self._ends(i, s) for i in range(len(self._members))))
