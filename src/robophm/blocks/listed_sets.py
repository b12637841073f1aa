"""The minimal sets that matter most, one by one, and what all others come to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import islice, takewhile

from numpy.typing import ArrayLike

from robophm.blocks.cut_sets import MinimalSet, MinimalSets

ORDERS = 10
"""Numbers of sets are stated of 1, 2, … so many parts."""


@dataclass(frozen=True)
class ListedSets:
    """Some minimal sets of a system, and what is known of all of them."""

    count: int
    """Number of all minimal sets."""
    by_order: tuple[int, ...]
    """Numbers of sets of 1, 2, … ORDERS parts."""
    mass: float
    """Sum of the probabilities of all."""
    sets: tuple[MinimalSet, ...]
    neglected: float
    """Sum of the probabilities of those that are not among ``sets``."""
    whole: float
    """P(the system has failed) of cut sets, P(it works) of path sets; not a number where it is only bounded."""
    cut_off: float = 0.0
    """The share of its module's probability below which a set may be missing here; 0 where none is, infinite where
    likelier ones than those found may be missing too."""

    def share(self, one: MinimalSet) -> float:
        """Return P(all of a set have failed, or work) over that of the system; NaN where the system's is 0."""
        return one.probability / self.whole if self.whole > 0 else math.nan


def list_sets(
    sets: MinimalSets, probability: ArrayLike, whole: float, most: int, order: int | None = None, cut_off: float = 0.0
) -> ListedSets:
    """Return the ``most`` likeliest sets; with an ``order`` the smallest, of at most so many parts, likeliest first.

    ``probability`` is that of each event, shape (events,), ``whole`` that of the system, ``cut_off`` that of ``sets``.
    Raises StructureError where too many sets are alike in what they are sorted by.
    """
    if order is None:
        found = sets.likeliest(probability)
    else:
        found = takewhile(lambda one: len(one.names) <= order, sets.smallest(probability))
    some, count, mass = tuple(islice(found, most)), sets.count(), sets.mass(probability)
    rest = max(mass - math.fsum(one.probability for one in some), 0.0) if len(some) < count else 0.0
    return ListedSets(count, tuple(sets.count_by_order(ORDERS)), mass, some, rest, whole, cut_off)
