"""A fault tree with the probabilities of its events: that of its top event, and its minimal sets."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.fault_tree import FaultTree, dual
from robophm.blocks.listed_sets import ListedSets, list_sets

Array = npt.NDArray[np.float64]


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

    def cut_sets(self, most: int, order: int | None = None) -> ListedSets:
        """Return the smallest sets of events that bring it about; arguments as of ``list_sets``.

        Raises StructureError for a tree with "not" or "xor", and where there are too many sets.
        """
        return list_sets(MinimalSets(self.tree), self.occurred, self.probability, most, order)

    def path_sets(self, most: int, order: int | None = None) -> ListedSets:
        """Return the smallest sets of events whose absence is enough for it not to occur; as ``cut_sets``."""
        self.tree.must_be_coherent("has no minimal path sets")
        works = FaultTree(self.tree.names, dual(self.tree.gates), self.tree.limit)
        return list_sets(MinimalSets(works), self.not_yet, 1.0 - self.probability, most, order)
