"""A member of a group: its failure modes in series, and how they age while it waits and while it works."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robophm.groups.path import Array, Path, Rows
from robophm.groups.quadrature import log_integral
from robophm.groups.solved_group import log_fails
from robophm.life.distribution import FAINT, LifeDistribution
from robophm.life.exponential import Exponential


@dataclass(frozen=True)
class Mode:
    """A failure mode of a member."""

    column: int
    """Column of the mode's age in the arrays of a path."""
    life: LifeDistribution
    age: float = 0.0
    """Age at the start of the path."""
    multiplicity: float = 1.0
    """Number of equal parts in series that it is of."""
    always: bool = False
    """Whether it ages as if it stood alone, whether its member waits, works, or bears more than its share."""

    @property
    def constant_rate(self) -> bool:
        """Whether the hazard rate is the same at every age."""
        return isinstance(self.life, Exponential) and self.life.location == 0


Member = Sequence[Mode]


def alike(members: Sequence[Member], path: Path) -> bool:
    """Whether all members have the same lives and ages, and age alike."""
    kinds = {tuple((mode.life, mode.age, mode.multiplicity, mode.always) for mode in member) for member in members}
    if len(kinds) > 1:
        return False
    return all(
        np.array_equal(path.speed[:, one.column], path.speed[:, first.column])
        for member in members
        for one, first in zip(member, members[0], strict=True)
    )


def _waiting(mode: Mode, dormancy: float) -> float:
    """The share of its speed at which it ages while its member waits."""
    return 1.0 if mode.always else dormancy


def waiting_hazard(member: Member, path: Path, s: Array, dormancy: float) -> Array:
    """Cumulative hazard that a spare gathers while it waits from the start to ``s``."""
    total, ages = np.zeros(np.shape(s)), path.at(s)
    for mode in member:
        if share := _waiting(mode, dormancy):
            total += mode.multiplicity * mode.life.increment(mode.age, share * ages[mode.column])
    return total


def waiting_more(member: Member, path: Path, s: Array, length: Array, dormancy: float) -> Array:
    """The cumulative hazard that a waiting member gathers in the stretch after ``s``."""
    total, ages, more = np.zeros(np.broadcast(s, length).shape), path.at(s), path.between(s, length)
    for mode in member:
        if share := _waiting(mode, dormancy):
            age = mode.age + share * ages[mode.column]
            total += mode.multiplicity * mode.life.increment(age, share * more[mode.column])
    return total


def working_hazard(member: Member, path: Path, since: Array, length: Array, dormancy: float, then: Array | None = None,
) -> Array:  # fmt: skip
    """Cumulative hazard of a member that works since then; of the stretch ``then`` after that ``length`` if given."""
    total = np.zeros(np.broadcast(since, length).shape)
    ages, gained = path.at(since), path.between(since, length)
    more = gained if then is None else path.between(since + length, then)
    for mode in member:
        age = mode.age + _waiting(mode, dormancy) * ages[mode.column]
        if then is not None:
            age = age + gained[mode.column]
        total = total + mode.multiplicity * mode.life.increment(age, more[mode.column])
    return total


def latest(member: Member, path: Path, s: Array, dormancy: float) -> Array:
    """Return the latest time since when it must work to be able to fail at ``s``: ``s``, but for lives with a
    location."""
    found, ages = np.zeros(np.shape(s)), path.at(s)
    for mode in member:
        rest, waits = getattr(mode.life, "location", 0.0) - mode.age, _waiting(mode, dormancy)
        since = s
        if rest > 0:
            over = ages[mode.column] - rest
            since = np.where(over < 0, 0.0, s)
            if waits < 1:
                since = np.minimum(since, path.when(mode.column, np.maximum(over, 0.0) / (1 - waits)))
        found = np.maximum(found, since)
    return found


def log_rate(ageing: Iterable[tuple[Mode, Array, Array]]) -> Array:
    """ln of the hazard rate per unit of s of failure modes in series, each at an age and a speed."""
    modes = list(ageing)
    rate = sum(
        np.where(speed > 0, mode.multiplicity * speed * np.minimum(mode.life.hazard(age), 1e300), 0.0)
        for mode, age, speed in modes
    )
    with np.errstate(divide="ignore"):
        log = np.log(rate)
        if np.any(faint := rate < FAINT):
            logs = [np.log(mode.multiplicity * speed) + mode.life.log_hazard(age) for mode, age, speed in modes]
            log = np.where(faint, np.logaddexp.reduce(logs), log)
    return log


def log_waiting_fails(member: Member, path: Path, s: Array, dormancy: float) -> Array:
    """ln P(a spare that waits has failed by ``s``), however small."""
    hazard = waiting_hazard(member, path, s, dormancy)
    found, faint = log_fails(hazard), hazard < FAINT
    ageing = [(mode, share) for mode in member if (share := _waiting(mode, dormancy))]
    if ageing and np.any(faint):

        def rate(which: Rows, place: Array, rest: Array) -> Array:
            ages, piece = path.at(place), path.piece(place)
            return log_rate(
                (mode, mode.age + share * ages[mode.column], share * path.speed[piece, mode.column])
                for mode, share in ageing
            )

        found[faint] = log_integral(rate, np.zeros(np.count_nonzero(faint)), s[faint], path.corners[1:].tolist())
    return found


def log_density(member: Member, path: Path, since: Array, length: Array, end: Array, dormancy: float) -> Array:
    """ln of the failure density at ``end``, per unit of s, of a member that works since ``length`` before it.

    The end is told apart: at a corner of the path, rounding of the sum would put it on either piece.
    """
    ages, gained = path.at(since), path.between(since, length)
    piece = path.piece(end)
    lived = np.zeros(np.broadcast(since, length).shape)
    ageing = []
    for mode in member:
        age = mode.age + _waiting(mode, dormancy) * ages[mode.column]
        ageing.append((mode, age + gained[mode.column], path.speed[piece, mode.column]))
        lived = lived + mode.multiplicity * mode.life.increment(age, gained[mode.column])
    return np.where(lived > 1e100, -np.inf, log_rate(ageing) - lived)
