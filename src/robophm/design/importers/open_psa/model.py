"""A question that an Open-PSA model answers: its fault tree, with the probabilities of the basic events."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.top_event import TopEvent
from robophm.core.errors import StructureError
from robophm.core.markup import Element
from robophm.design.importers.open_psa.expressions import Life
from robophm.design.importers.open_psa.names import name_of

Array = npt.NDArray[np.float64]
NO_EVENTS: Array = np.empty(0)


class Drawable(Protocol):
    """Probabilities of basic events that may be uncertain."""

    @property
    def uncertain(self) -> int:
        """Return how many uncertain expressions there are, of which the means were taken."""

    def drawn(self, count: int, seed: int) -> Array:
        """Return (p, 1 − p) of each event in so many draws; shape (2, events, draws)."""


@dataclass(frozen=True)
class Model:
    """A fault tree with the probabilities of its basic events at the mission time.

    Of a sequence of an event tree, given that its initiating event has occurred.
    """

    name: str
    """Name of the top event, or of the initiating event and the sequence, and of the phase of an alignment."""
    tree: FaultTree | None
    """The fault tree; None where house events, constants and the expressions of an event tree decide the top event."""
    occurred: Array
    """Probability of each basic event of the tree."""
    not_yet: Array
    decided: float = 0.0
    """The probability, where there is no tree."""
    lives: tuple[Life | None, ...] = ()
    """Life of each basic event that fails as a part does; None where only its probability is known."""
    initiating: str = ""
    """The initiating event of a sequence, and the phase: the sequences of one of them add up to 1 where each of its
    ways ends in a sequence and no two of them can come true at once."""
    chances: Drawable | None = None
    """The expressions of its probabilities; None where there are none."""
    exchanged: bool = False
    """Whether it is the tree of the minimal cut sets in which substitutions have exchanged events."""
    time: float | None = None
    """Mission time [h]; None where none is given."""
    no_chance: tuple[Element, ...] = ()
    """Definitions of basic events without a probability. Where there are any, all probabilities are one half."""

    def top_event(self) -> TopEvent:
        """Return its top event, with the probabilities of its basic events.

        Raises StructureError where constants and house events decide it, DesignError where an event has no probability.
        """
        if self.no_chance:
            first, more = self.no_chance[0], len(self.no_chance) - 1
            also = f", nor {more} more" if more else ""
            raise first.fault(f"'{name_of(first)}' has no probability{also}; expected one of each basic event")
        return self.structure()

    def structure(self) -> TopEvent:
        """Return its top event, whose probabilities mean nothing where an event has none; raises as ``top_event``."""
        if self.tree is None:
            raise StructureError(f"'{self.name}' {self.decision}")
        return TopEvent(self.tree, self.occurred, self.not_yet)

    def probability(self) -> float:
        """Return the probability of the top event. Raises StructureError where it is too large to solve exactly."""
        return self.top_event().probability if self.tree else self.decided

    def drawn(self, count: int, seed: int) -> Array:
        """Return the probability of the top event in so many draws of what is uncertain; shape (draws,).

        A Latin hypercube. Raises StructureError where the tree is too large to solve exactly, RobophmError for too many
        draws.
        """
        if self.tree is None or self.chances is None:
            raise StructureError(f"'{self.name}' has no basic events with probabilities, which could be drawn")
        occurred, not_yet = self.chances.drawn(count, seed)
        return self.tree.probability(occurred, not_yet)

    @property
    def decision(self) -> str:
        """Return in words what is decided where there is no tree."""
        if 0 < self.decided < 1:
            return f"occurs with {self.decided:.6g} (exact): the expressions of its event tree decide it"
        return f"{'always' if self.decided else 'never'} occurs (exact): constants and house events decide it"
