"""Standby and load sharing of parts with constant rates: a Markov chain over which of them have failed, exactly.

Along a straight piece of the path its rates are constant. The matrix exponential is made of positive terms alone
(uniformisation, Jensen 1953, then squaring), so that equal or nearly equal rates cancel nothing and a probability of
1e-30 has all its digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robophm.blocks.diagram import LoadSharing, Standby
from robophm.core.errors import StructureError
from robophm.groups.member import Member
from robophm.groups.path import Array, Path, Rows
from robophm.groups.solved_group import SolvedGroup

MOST_STATES = 256
"""The most states of a group of different parts; equal ones are only counted, and may be far more."""


_TERMS = 24  # of an exponential over a short time


class Transition(NamedTuple):
    """A member fails, which brings the group from one state to another; ``end`` None: it fails."""

    start: int
    end: int | None
    member: int
    weight: float
    """Factor on the member's rate."""
    always: float
    """Factor on the rate of what the member depends on."""


class Chain(SolvedGroup):
    """A group of members with constant rates along a path, from its start on.

    ``status`` at ``now``: of each member True works, False has failed, None. Raises StructureError where the members
    are too many that differ.
    """

    def __init__(
        self, group: Standby | LoadSharing, members: Sequence[Member], path: Path, now: float,
        status: Sequence[bool | None],
    ) -> None:  # fmt: skip
        self.now, self.told = now, any(one is not None for one in status)
        self._path = path
        rates, always = (np.zeros((len(path.corners), len(members))) for _ in range(2))
        for i, member in enumerate(members):
            for mode in member:
                of = always if mode.always else rates
                of[:, i] += mode.multiplicity * mode.life.hazard(mode.age) * path.speed[:, mode.column]
        alike = all(bool(np.all(of == of[:, :1])) for of in (rates, always)) and (None not in status or not self.told)
        if alike:
            status = sorted(status, key=lambda one: one is not False)  # whichever has failed
        states, transitions = reachable(group, alike, bool(always.any()))
        if len(states) > MOST_STATES:
            raise StructureError(
                f"{group.name}: {len(states)} states of different parts; expected at most {MOST_STATES}"
            )
        n = len(states)
        self._generators = np.zeros((len(rates), n + 1, n + 1))
        for start, end, i, weight, alone in transitions:
            self._generators[:, start, n if end is None else end] += weight * rates[:, i] + alone * always[:, i]
        self._consistent = np.array([
            all(said is None or said is not bool(failed >> i & 1) for i, said in enumerate(status)) for failed in states
        ])  # fmt: skip
        self._start = np.zeros(n)
        self._start[0] = 1.0
        self._begins = self._along()

    def _along(self) -> list[tuple[float, Array, float]]:
        """(since when, the states then, ln of their sum) of every piece; a new one begins now."""
        v, log, at = self._start, 0.0, 0.0
        begins = []
        for corner in sorted({*self._path.corners.tolist(), self.now}):
            v, log = self._carried(v, log, at, corner)
            if corner == self.now and self.told:
                v, log = _normal(v * self._consistent, log)
            at = corner
            begins.append((at, v, log))
        return begins

    def _carried(self, v: Array, log: float, start: float, end: float) -> tuple[Array, float]:
        if end <= start:
            return v, log
        working, _, shift = exponential(self._generators[self._path.piece(np.array([start]))], np.array([end - start]))
        return _normal(v @ working[0], log + float(shift[0]))

    def _states(self, s: Array) -> tuple[Array, Array, Rows]:
        """The states at times, shape (times, states), ln of their sums, and the piece that each lies on."""
        at = np.array([begin for begin, _, _ in self._begins])
        which = np.searchsorted(at, s, side="right") - 1
        piece = self._path.piece(at)[which]
        working, _, shift = exponential(self._generators[piece], s - at[which])
        v = np.array([v for _, v, _ in self._begins])[which]
        log = np.array([log for _, _, log in self._begins])[which] + shift
        v = np.einsum("ti,tij->tj", v, working)
        total = v.sum(axis=1)
        with np.errstate(divide="ignore"):
            return v / np.where(total > 0, total, 1.0)[:, None], log + np.log(total), piece

    def log_works(self, s: Array) -> Array:
        """Return ln P(works at s, and what is known), shape (times,)."""
        return self._states(s)[1]

    def log_fails_in(self, s: Array, length: Array) -> Array:
        """ln P(works at s, fails in the stretch after it, and what is known)."""
        v, log, piece = self._states(s)
        _, failed, _ = exponential(self._generators[piece], length)
        with np.errstate(divide="ignore"):
            result: Array = log + np.log(np.einsum("ti,ti->t", v, failed))
        return result

    def log_stays(self, s: Array, length: Array, works: Array) -> Array:
        """ln P(works at the end of the stretch | works at s), with all digits of a short stretch."""
        v, _, piece = self._states(s)
        working, _, shift = exponential(self._generators[piece], length)
        with np.errstate(divide="ignore"):
            result: Array = shift + np.log(np.einsum("ti,tij->t", v, working))
        return result

    def log_density(self, s: Array) -> Array:
        """ln of the failure density at s, and what is known; per unit of s."""
        v, log, piece = self._states(s)
        with np.errstate(divide="ignore"):
            result: Array = log + np.log(np.einsum("ti,ti->t", v, self._generators[piece][:, :-1, -1]))
        return result


def reachable(group: Standby | LoadSharing, alike: bool, depend: bool = False) -> tuple[list[int], list[Transition]]:
    """The states, as bits of the members that have failed, all working first; and what leads from each to others.

    Of members ``alike``, only how many have failed counts: the lowest bits. ``depend``: some depend on others.
    """
    states, transitions = {0: 0}, list[Transition]()
    todo = [0]
    while todo and len(states) <= MOST_STATES:
        failed = todo.pop()
        for i, step, weight, always in failures(group, failed):
            if weight == 0 and not (depend and always):
                continue
            if step is not None and alike:
                step = (1 << step.bit_count()) - 1
            if step is not None and step not in states:
                states[step] = len(states)
                todo.append(step)
            transitions.append(Transition(states[failed], None if step is None else states[step], i, weight, always))
    return list(states), transitions


def failures(group: Standby | LoadSharing, failed: int) -> list[tuple[int, int | None, float, float]]:
    """The failures that are possible in a state: (member, the state that it leads to, weights as of a Transition)."""
    alive = [i for i in range(len(group.members)) if not failed >> i & 1]
    if isinstance(group, LoadSharing):
        factor = group.factors[len(group.members) - len(alive)]
        return [(i, failed | 1 << i if len(alive) > group.k else None, factor, 1.0) for i in alive]
    found: list[tuple[int, int | None, float, float]] = []
    for place, i in enumerate(alive):
        if place >= group.active:
            found.append((i, failed | 1 << i, group.dormancy, 1.0))
        elif len(alive) > group.active:
            made, missed = group.switch, 1 - group.switch
            found += [(i, failed | 1 << i, made, made), (i, None, missed, missed)]
        else:
            found.append((i, None, 1.0, 1.0))
    return found


def exponential(rates: Array, durations: Array) -> tuple[Array, Array, Array]:
    """exp of generators given by their rates ≥ 0 off the diagonal, shape (times, n + 1, n + 1), over durations.

    Of the n working states: to each other, shape (times, n, n), times exp of the last result; to the failed one, n.
    What has failed stays so: a state is left for good, so that it lasts exp(−rate·time), which is put in its place
    whenever time doubles. What leads from one state to another is then as good as the few steps that it takes,
    however often time doubles and however far apart the rates are. (Al-Mohy and Higham 2009, §2, for any triangle.)
    """
    n = rates.shape[-1]
    out = rates.sum(axis=2)
    slowest = out[:, :-1].min(axis=1)
    faster = out[:, :-1] - slowest[:, None]
    most = np.maximum(out.max(axis=1), 1e-300)
    with np.errstate(over="ignore"):
        turns = np.where(durations > 0, most * durations, 0.0)
    turns = np.minimum(turns, 1e290)
    # So short a time to begin with that of n steps hardly more than a few fall into one such.
    halvings = np.maximum(np.ceil(np.log2(np.maximum(turns, 1e-300))), 0).astype(int) + 4 + int(np.log2(n))
    small = turns / 2.0**halvings
    time = small / most
    step = rates / most[:, None, None]
    diagonal = np.arange(n)
    step[:, diagonal, diagonal] += 2 - out / most[:, None]  # twice as many events as there are: none is left over
    step /= 2
    term = np.broadcast_to(np.eye(n), step.shape).copy()
    total = term.copy()
    for k in range(1, _TERMS):
        term = term @ step * (2 * small / k)[:, None, None]
        total += term
    total *= np.exp(-2 * small)[:, None, None]
    failed = total[:, :-1, -1].copy()
    working = total[:, :-1, :-1] * np.exp(slowest * time)[:, None, None]
    diagonal = diagonal[:-1]
    working[:, diagonal, diagonal] = np.exp(-faster * time[:, None])
    power = np.zeros(len(rates))  # of two, by which working has been divided
    for k in range(int(halvings.max(initial=0))):
        here = halvings > k
        now, log = working[here], power[here] * np.log(2.0) - slowest[here] * time[here]
        failed[here] += np.exp(log)[:, None] * np.einsum("tij,tj->ti", now, failed[here])
        now = now @ now
        exponent = np.frexp(now.max(axis=(1, 2)))[1]
        time[here] *= 2
        power[here] = 2 * power[here] + exponent
        with np.errstate(over="ignore"):
            lasts = -faster[here] * time[here, None] - power[here, None] * np.log(2.0)
        now = np.ldexp(now, -exponent[:, None, None])
        now[:, diagonal, diagonal] = np.exp(np.minimum(lasts, 1.0))
        working[here] = now
    return working, failed, power * np.log(2.0) - slowest * time


def _normal(v: Array, log: float) -> tuple[Array, float]:
    total = float(v.sum())
    return (v / total, log + float(np.log(total))) if total > 0 else (v, -np.inf)
