"""Cold standby with several active parts that age: each place takes the next spare when its own part fails.

The spares are equal, and one is as good as new when it is called, whoever calls. So the places are independent
sequences of lives, of which only the number of failures counts: the group works while all together are at most as many
as there are spares. The parts that are active first may differ, in age too.

Source: Barlow and Proschan, "Statistical theory of reliability and life testing" (1975), chapter 6.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Standby
from robophm.core.errors import StructureError
from robophm.groups.member import Member, alike
from robophm.groups.path import Array, Path, Rows
from robophm.groups.quadrature import log_integral, log_sum
from robophm.groups.solved_group import SolvedGroup
from robophm.groups.standby_one_active import OneActiveStandby
from robophm.groups.table import LogTable


class SeveralActiveStandby(SolvedGroup):
    """A standby group with several active members along a path; ``status`` at ``now``: True works, False failed, None.

    Raises StructureError where spares differ, or something is known of one but the last.
    """

    def __init__(
        self, group: Standby, members: Sequence[Member], path: Path, now: float, status: Sequence[bool | None]
    ) -> None:
        first, spares = members[: group.active], members[group.active :]
        if not alike(spares, path) or any(one is not None for one in status[group.active : -1]):
            raise StructureError(
                f"{group.name}: {group.active} active of parts that age have no exact solution once spares differ in "
                "age or something is known of one that is not the last; expected new spares, "
                "or an estimate by simulation"
            )
        self.now, self.told = now, any(one is not None for one in status)
        self._dead = status[-1] is False  # with the last cold spare, which only fails when called
        self._spares = len(spares)
        with np.errstate(divide="ignore"):
            self._taken, self._missed = np.log(group.switch), np.log1p(-group.switch)
        order = replace(group, members=tuple((str(i),) for i in range(self._spares + 2)), active=1, switch=1.0)
        kinds: dict[object, _Place] = {}
        self._places = []
        for member, said in zip(first, status, strict=False):
            kind = said, *((replace(mode, column=0), path.speed[:, mode.column].tobytes()) for mode in member)
            if kind not in kinds:
                lives = OneActiveStandby(
                    order, [member, *spares, spares[0]], path, now, [said, *[None] * (self._spares + 1)]
                )
                kinds[kind] = _Place(lives, self._spares)
            self._places.append(kinds[kind])
        self._breaks = sorted({at for place in kinds.values() for at in place.lives.breaks})

    def over(self, s: Array, length: Array) -> npt.NDArray[np.bool_]:
        """Return where some place has gathered more than all spares can outlive."""
        found: npt.NDArray[np.bool_] = np.any([place.lives.over(s, length) for place in set(self._places)], axis=0)
        return found

    def _counts(self, places: Sequence[_Place], s: Array) -> list[Array]:
        """ln P(so many failures in these places until s), 0 … as many as there are spares."""
        total = [np.zeros(s.shape), *(np.full(s.shape, -np.inf) for _ in range(self._spares))]
        for one in places:
            failures = one.failures(s)
            total = [log_sum(*(total[i] + failures[k - i] for i in range(k + 1))) for k in range(len(failures))]
        return total

    def log_works(self, s: Array) -> Array:
        """ln P(works at s, and what is known), shape (times,)."""
        if self._dead:
            return np.full(s.shape, -np.inf)
        return log_sum(*(count + self._calls(k) for k, count in enumerate(self._counts(self._places, s))))

    def _calls(self, count: int) -> float:
        """ln P(so many switches came off)."""
        return float(count * self._taken) if count else 0.0

    def log_density(self, s: Array) -> Array:
        """ln of the failure density at s, and what is known; per unit of s."""
        found = [np.full(s.shape, -np.inf)]
        for place, times in Counter(self._places).items():
            rest = list(self._places)
            rest.remove(place)
            for i, others in enumerate(self._counts(rest, s)):
                for k in range(self._spares + 1 - i):
                    last = 0.0 if i + k == self._spares else float(self._missed)
                    found.append(np.log(times) + others + place.lives.fails(k, s) + self._calls(i + k) + last)
        return np.full(s.shape, -np.inf) if self._dead else log_sum(*found)

    def log_fails_in(self, s: Array, length: Array) -> Array:
        """ln P(works at s, fails in the stretch after it, and what is known)."""

        def log_f(which: Rows, place: Array, rest: Array) -> Array:
            return self.log_density(place)

        return log_integral(log_f, s, s + length, self._breaks)


class _Place:
    """The parts that are active at one place, one after the other, as often as there are spares."""

    def __init__(self, lives: OneActiveStandby, spares: int) -> None:
        self.lives = lives
        scale = lives.scale()
        self._serves = [LogTable(partial(lives.serves, i), lives.breaks, scale) for i in range(1, spares + 1)]

    def failures(self, s: Array) -> list[Array]:
        """ln P(0, 1 … so many failures until s)."""
        return [self.lives.serves(0, s.ravel()).reshape(s.shape), *(table(s) for table in self._serves)]
