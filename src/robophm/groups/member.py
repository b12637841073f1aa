"""One member of a group: its failure modes in series, and how they age while it waits and while it works."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robophm.groups.path import Array, Path
from robophm.groups.table import SMALLEST
from robophm.life.distribution import LifeDistribution
from robophm.life.exponential import Exponential


@dataclass(frozen=True)
class Mode:
    """One failure mode of a member."""

    column: int
    """Which of the ages along a path is its own."""
    life: LifeDistribution
    age: float = 0.0
    """At the start of the path."""
    multiplicity: float = 1.0
    """Equal parts in series that it is of."""
    always: bool = False
    """Whether it ages as if it stood alone, whether its member waits, works, or bears more than its share."""

    @property
    def constant_rate(self) -> bool:
        """Whether its age does not matter."""
        return isinstance(self.life, Exponential) and self.life.location == 0


Member = Sequence[Mode]


def alike(members: Sequence[Member], path: Path) -> bool:
    """Whether all have the same lives and ages, and age alike."""
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
    """What it gathers in the stretch after ``s``."""
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


def log_density(member: Member, path: Path, since: Array, length: Array, end: Array, dormancy: float) -> Array:
    """ln of the failure density at ``end``, per unit of s, of a member that works since ``length`` before it.

    The end is told apart: at a corner of the path, rounding of the sum would put it on either piece.
    """
    ages, gained = path.at(since), path.between(since, length)
    piece = path.piece(end)
    hazard, lived = np.zeros(np.broadcast(since, length).shape), np.zeros(np.broadcast(since, length).shape)
    for mode in member:
        age = mode.age + _waiting(mode, dormancy) * ages[mode.column]
        speed = path.speed[piece, mode.column]
        here = mode.life.hazard(age + gained[mode.column])
        hazard = hazard + np.where(speed > 0, mode.multiplicity * speed * np.minimum(here, 1e300), 0.0)
        lived = lived + mode.multiplicity * mode.life.increment(age, gained[mode.column])
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where((lived > 1e100) | (hazard < SMALLEST), -np.inf, np.log(hazard) - lived)
