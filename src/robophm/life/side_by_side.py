"""Many distributions as few: those of a class become one whose parameters are arrays, asked by one call.

Row i of every array is of the i-th distribution; further axes broadcast. Ages are those of parts, never below 0, and
durations are not negative: nothing is checked here, because this is what live ticks and fleets call.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.life.distribution import Array, LifeDistribution, limits


def kind(life: LifeDistribution) -> object:
    """A key that distributions share which can be evaluated together."""
    return type(life) if life.closed_form else life


class _Together(NamedTuple):
    rows: slice | NDArray[np.intp]
    life: LifeDistribution
    """Distribution whose parameters are columns, or numbers where all are equal."""
    plain: bool
    """Whether x is the age, so that H and h may be asked of it directly."""


class Lives:
    """Distributions side by side; of each, hazards are multiplied by its ``share``.

    Those of a kind are best told one after the other: nothing is then to be looked up.
    """

    def __init__(self, lives: Sequence[LifeDistribution], share: ArrayLike = 1.0) -> None:
        self._lives = tuple(lives)
        self._share: Array = np.broadcast_to(np.asarray(share, dtype=float), (len(self._lives),))
        self._shared = bool(np.any(self._share != 1.0))
        groups: dict[object, list[int]] = {}
        for i, life in enumerate(self._lives):
            groups.setdefault(kind(life), []).append(i)
        self._members = list(groups.values())
        self._of_axes: dict[int, list[_Together]] = {}

    def increment(self, age: Array, duration: Array) -> Array:
        """H(age + duration) − H(age); an argument of one row is that of all."""
        found = np.empty((len(self._lives), *np.broadcast(age, duration).shape[1:]))
        with limits():
            for rows, life, plain in self._classes(found.ndim):
                x = age[rows] if len(age) == len(found) else age
                d = duration[rows] if len(duration) == len(found) else duration
                found[rows] = life._increment(x, d) if plain else life.increment(x, d)
        if not duration.all():
            np.copyto(found, 0.0, where=duration == 0)
        return self._weighed(found)

    def at_pace(self, age: Array, pace: Array) -> Callable[[Array], Array]:
        """H(age + pace·t) − H(age) as a function of times t; shape (distributions, times, draws).

        ``age`` and ``pace`` have shape (distributions, draws).
        """
        with limits():
            along = [
                (one.rows, _along(one, age[one.rows][:, None], pace[one.rows][:, None])) for one in self._classes(3)
            ]

        def added(times: Array) -> Array:
            with limits():
                if len(along) == 1:
                    return self._weighed(along[0][1](times))
                found = np.empty((len(self._lives), len(times), pace.shape[1]))
                for rows, gathered in along:
                    found[rows] = gathered(times)
            return self._weighed(found)

        return added

    def hazard(self, age: Array) -> Array:
        """The hazard rates h(age) [1/clock], shape (distributions, ...)."""
        found = np.empty(age.shape)
        with limits():
            for rows, life, plain in self._classes(found.ndim):
                found[rows] = life._hazard(age[rows]) if plain else life.hazard(age[rows])
        return self._weighed(found)

    def hazards(self, age: Array) -> tuple[Array, Array]:
        """H gathered since age 0, and h(age) [1/clock]; what both are made of is computed once."""
        gathered, now = np.empty(age.shape), np.empty(age.shape)
        with limits():
            for rows, life, plain in self._classes(age.ndim):
                x = age[rows]
                gathered[rows], now[rows] = (
                    life._hazards(x) if plain else (life.increment(np.zeros_like(x), x), life.hazard(x))
                )
        return self._weighed(gathered), self._weighed(now)

    def _weighed(self, hazard: Array) -> Array:
        if self._shared:
            hazard *= self._share.reshape(-1, *[1] * (hazard.ndim - 1))
        return hazard

    def _classes(self, ndim: int) -> list[_Together]:
        """The distributions by class, for arrays of so many axes."""
        if ndim not in self._of_axes:
            self._of_axes[ndim] = [self._together(members, ndim) for members in self._members]
        return self._of_axes[ndim]

    def _together(self, members: list[int], ndim: int) -> _Together:
        first, last = members[0], members[-1]
        rows = slice(first, last + 1) if len(members) == last + 1 - first else np.array(members)
        life = self._lives[first]
        if any(self._lives[i] != life for i in members):
            life = object.__new__(type(life))
            for name in life.dimensions:
                values = np.array([getattr(self._lives[i], name) for i in members])
                object.__setattr__(life, name, values.reshape(-1, *[1] * (ndim - 1)))
        plain = life.closed_form and life.lowest == 0 and not np.any(life._origin)
        return _Together(rows, life, plain)


def _along(together: _Together, age: Array, pace: Array) -> Callable[[Array], Array]:
    """``Lives.at_pace`` of one class; arguments of shape (distributions, 1, draws)."""
    _, life, plain = together
    if plain and not age.any():
        return life._new_at_pace(pace)

    def added(times: Array) -> Array:
        duration = pace * times[:, None]
        if not plain:
            return life.increment(age, duration)
        found = life._increment(age, duration)
        return found if duration.all() else np.where(duration == 0, 0.0, found)

    return added
