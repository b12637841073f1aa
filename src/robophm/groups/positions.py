"""Cold standby with several active: equal parts that age, of which each place takes the next spare when its own fails.

A spare is as good as new when it is called, whoever calls. So the places are independent renewal processes, of which
only the number of failures counts: the group works while all together are at most as many as there are spares.

Source: Barlow and Proschan, "Statistical theory of reliability and life testing" (1975), chapter 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from robophm.blocks.diagram import Standby
from robophm.core.errors import StructureError
from robophm.groups.member import Member, alike
from robophm.groups.path import Array, Path, Rows
from robophm.groups.quadrature import log_integral, log_sum
from robophm.groups.sequence import InOrder
from robophm.groups.state import Solved
from robophm.groups.table import LogTable


class Positions(Solved):
    """Such a group along a path; nothing is known of its members but how it began. Raises StructureError."""

    def __init__(
        self, group: Standby, members: Sequence[Member], path: Path, now: float, status: Sequence[bool | None]
    ) -> None:
        if not alike(members, path) or any(one is not None for one in status):
            raise StructureError(
                f"{group.name}: {group.active} active of parts that age have no exact solution once they differ in age "
                "or something is known of one; expected parts all new, or robophm show DESIGN --monte-carlo 100000"
            )
        self.now, self.told = now, False
        self._spares, self._places = len(members) - group.active, group.active
        with np.errstate(divide="ignore"):
            self._taken, self._missed = np.log(group.switch), np.log1p(-group.switch)
        count = self._spares + 2
        names = tuple((str(i),) for i in range(count))
        self._place = InOrder(replace(group, members=names, active=1, switch=1.0), [members[0]] * count, path, 0.0,
                              [None] * count)  # fmt: skip
        scale = self._place.scale()
        self._failed = [
            LogTable(partial(self._place.serves, i), self._place.breaks, scale) for i in range(1, self._spares + 1)
        ]

    def over(self, s: Array, length: Array) -> np.ndarray:
        """Where no place could have had enough."""
        return self._place.over(s, length)

    def _counts(self, places: int, s: Array) -> list[Array]:
        """ln P(so many failures in some places until s), 0 … as many as there are spares."""
        one = [self._place.serves(0, s.ravel()).reshape(s.shape), *(table(s) for table in self._failed)]
        total = [np.zeros(s.shape), *(np.full(s.shape, -np.inf) for _ in self._failed)]
        for _ in range(places):
            total = [log_sum(*(total[i] + one[k - i] for i in range(k + 1))) for k in range(len(one))]
        return total

    def log_works(self, s: Array) -> Array:
        """As of Solved."""
        return log_sum(*(count + self._calls(k) for k, count in enumerate(self._counts(self._places, s))))

    def _calls(self, count: int) -> float:
        """ln P(so many switches came off)."""
        return float(count * self._taken) if count else 0.0

    def log_density(self, s: Array) -> Array:
        """As of Solved."""
        others, found = self._counts(self._places - 1, s), []
        for i, other in enumerate(others):
            for k in range(self._spares + 1 - i):
                last = 0.0 if i + k == self._spares else float(self._missed)
                found.append(other + self._place.fails(k, s) + self._calls(i + k) + last)
        density: Array = np.log(self._places) + log_sum(*found)
        return density

    def log_fails_in(self, s: Array, length: Array) -> Array:
        """As of Solved."""

        def log_f(which: Rows, place: Array, rest: Array) -> Array:
            return self.log_density(place)

        return log_integral(log_f, s, s + length, self._place.breaks)
