"""A fault tree with the probabilities of its events: that of its top event, and its minimal sets."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np
import numpy.typing as npt

from robophm.blocks.bounds import Bounds, Chance
from robophm.blocks.cut_sets import MinimalSet, MinimalSets
from robophm.blocks.fault_tree import FaultTree, dual
from robophm.blocks.graph import ALL, UNIT, Gate
from robophm.blocks.listed_sets import ListedSets, list_sets
from robophm.blocks.nodes import TooLargeError
from robophm.blocks.prime_implicants import PrimeImplicants

Array = npt.NDArray[np.float64]

_LEAST = 1.0
"""Seconds that all minimal sets may take in any case, however long the probability took."""

_SHARES = (1e-3, 1e-6, 1e-9)
"""Shares of a module's probability: where there are too many minimal sets, less likely ones are left out."""


@dataclass(frozen=True)
class TopEvent:
    """The top event of a fault tree at a time."""

    tree: FaultTree
    occurred: Array
    """Probability of each basic event; shape (events,)."""
    not_yet: Array
    """Complements of these probabilities, with their own digits."""

    @cached_property
    def probability(self) -> float:
        """Return P(top event). Raises StructureError where the tree is too large to solve exactly."""
        return float(self.tree.probability(self.occurred, self.not_yet))

    def within(self, seconds: float) -> Answer:
        """Return what can be said within a time: exact where the tree can be solved, else proved bounds.

        At most half of the time goes into solving it, unless that has been done before.
        """
        return Answer(self, seconds)

    def cut_sets(self, most: int, order: int | None = None) -> ListedSets:
        """Return the smallest sets of events that bring it about; arguments as of ``list_sets``.

        Of a tree with "not" or "xor" they are prime implicants, with what must not have occurred: "not valve". Raises
        StructureError where there are too many sets.
        """
        sets, chances = self._smallest(math.inf)
        return list_sets(sets, chances, self.probability, most, order)

    def _smallest(self, until: float) -> tuple[MinimalSets, Array]:
        """All minimal sets, and the probability of each event in them."""
        if self.tree.coherent:
            return MinimalSets(self.tree, until), self.occurred
        return PrimeImplicants(self.tree, until), np.concatenate([self.occurred, self.not_yet])

    def path_sets(self, most: int, order: int | None = None) -> ListedSets:
        """Return the smallest sets of events whose absence is enough for it not to occur; as ``cut_sets``."""
        self.tree.must_be_coherent("has no minimal path sets")
        works = FaultTree(self.tree.names, dual(self.tree.gates), self.tree.limit)
        return list_sets(MinimalSets(works), self.not_yet, 1.0 - self.probability, most, order)


class Answer:
    """The answer to how likely a top event is: its probability or proved bounds, with all minimal cut sets or some."""

    def __init__(self, event: TopEvent, seconds: float) -> None:
        begun = time.perf_counter()
        self._until = begun + seconds
        modular = event.tree.solved(begun + seconds / 2)
        self._event = event
        self.exact = not modular.unsolved
        """Whether the probability is exact; else it lies between bounds, which are proved."""
        self.modules = len(modular.parts)
        """Number of modules of the tree."""
        self.nodes = modular.size
        """Number of nodes of their decision diagrams, of those that were solved."""
        if self.exact:
            self._parts = modular.parts
            p, q = event.probability, 1.0 - event.probability
            self.chance = Chance(p, p, q, q)
            """Bounds of the probability; where it is exact they are equal."""
            return
        chances = [Chance(p, p, q, q) for p, q in zip(event.occurred.tolist(), event.not_yet.tolist(), strict=True)]
        found = Bounds(modular, chances, self._until - time.perf_counter())
        self._parts, self.chance = found.parts, found.chance

    def cut_sets(self, most: int, order: int | None = None) -> ListedSets:
        """Return minimal cut sets as ``TopEvent.cut_sets``; all are counted, or as many as can be in the time.

        Prime implicants are all found, or none.
        """
        tree, occurred = self._event.tree, self._event.occurred
        now = time.perf_counter()
        if self.exact:
            try:
                sets, chances = self._event._smallest(now + max((self._until - now) / 2, _LEAST))
                return list_sets(sets, chances, self.chance.low, most, order)
            except TooLargeError:
                pass
        found, smallest = None, math.inf
        for share in _SHARES if tree.coherent else ():
            try:
                found = MinimalSets.likely(tree, self._parts, occurred, share, self._until if found else math.inf)
            except TooLargeError:
                break
            smallest = share
        if found is None:
            return ListedSets(0, (), math.nan, (), math.nan, math.nan, math.inf)
        if self.exact:
            return list_sets(found, occurred, self.chance.low, most, order, smallest)
        return self._minimal_ones(found, most, order)

    def _minimal_ones(self, sets: MinimalSets, most: int, order: int | None) -> ListedSets:
        """Cut sets that were found, each without what is not needed in it: there may be likelier ones."""
        tree, chance = self._event.tree, dict(zip(self._event.tree.names, self._event.occurred.tolist(), strict=True))
        place = {name: i for i, name in enumerate(tree.names)}
        found: dict[tuple[str, ...], float] = {}
        for one in islice(sets.likeliest(self._event.occurred), most):
            kept = minimised(tree, [place[name] for name in one.names])
            names = tuple(tree.names[i] for i in kept)
            if order is None or len(names) <= order:
                found[names] = math.prod(chance[name] for name in names)
        listed = tuple(MinimalSet(names, p) for names, p in sorted(found.items(), key=lambda one: -one[1]))
        return ListedSets(len(listed), (), math.nan, listed, math.nan, math.nan, math.inf)


def minimised(tree: FaultTree, events: Sequence[int]) -> list[int]:
    """Return a minimal set of events, of these by number, that brings about the top of a coherent tree as they do."""
    kept = sorted(events)
    for one in sorted(events, reverse=True):
        fewer = [i for i in kept if i != one]
        if _occurs(tree.gates, set(fewer)):
            kept = fewer
    return kept


def _occurs(gates: Sequence[Gate], events: set[int]) -> bool:
    """Whether the top of a coherent tree occurs when just these events have."""
    true: list[bool] = []
    event = 0
    for k, inputs in gates:
        if k == UNIT:
            true.append(event in events)
            event += 1
        else:
            true.append(sum(true[i] for i in inputs) >= (len(inputs) if k == ALL else k))
    return true[-1]
