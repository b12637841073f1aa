"""Parts of unknown rate: how many there are in what is asked about, and what they make of its figures.

Such a part is carried as if it never failed. In a coherent structure that bounds survival since new from above. Hazard
rate, remaining life and task completion are of a system that works now: which of its redundant parts that leaves alive
depends on the unknown rate too, and may turn a figure either way. It cannot where the system hangs on each such part by
itself, nor where all else is known to work: then all figures are bounds.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robophm.blocks.diagram import Block
from robophm.design.robot import UNKNOWN, Component, Robot
from robophm.health.prognosis import Outlook
from robophm.health.worn import believed

IF_NEVER: Literal["if they never fail"] = "if they never fail"
Bound = Literal["at least", "at most", "if they never fail"]
"""How a stated figure stands to the truth."""


@dataclass(frozen=True)
class PartsOfUnknownRate:
    """What parts of unknown rate make of the figures of a system that they are in."""

    parts: int
    hazard_rate: Literal["at least", "if they never fail"]
    """What the stated hazard rate is."""
    reliability: Literal["at most"]
    """What survival since new is."""
    ahead: Literal["at most", "if they never fail"]
    """What remaining life and task completion are."""

    @property
    def failing(self) -> Literal["at least", "if they never fail"]:
        """What the probability of failing ahead is."""
        return "at least" if self.ahead == "at most" else IF_NEVER

    @property
    def words(self) -> str:
        """How many there are: "3 parts of unknown rate"."""
        return f"{self.parts:,} part{'s' * (self.parts != 1)} of {UNKNOWN} rate"

    @property
    def if_never(self) -> str:
        """Of what holds only then: "if they never fail"."""
        return "if it never fails" if self.parts == 1 else IF_NEVER

    def said(self, bound: Bound, text: str) -> str:
        """A figure in words: "at least …", "at most …", or "…, if they never fail"."""
        return f"{text}, {self.if_never}" if bound == IF_NEVER else f"{bound} {text}"

    def said_ahead(self, text: str) -> str:
        """A remaining life or probability of completion in words."""
        return self.said(self.ahead, text)

    @property
    def left_out(self) -> str:
        """How every sentence of them begins."""
        return f"{self.words} {'is' if self.parts == 1 else 'are'} left out of the totals"

    @property
    def sentence(self) -> str:
        """What they make of the figures of health."""
        bounded = "R, remaining life and PoTC are" if self.ahead == "at most" else "R is"
        if self.hazard_rate == "at least":
            return f"{self.left_out}: λ is at least, {bounded} at most what is stated"
        free = "λ is" if self.ahead == "at most" else "λ, remaining life and PoTC are"
        return f"{self.left_out}: {bounded} at most what is stated; {free} {self._free}"

    @property
    def of_tasks(self) -> str:
        """What they make of the probabilities that tasks are completed."""
        return f"{self.left_out}: every PoTC is {self._free if self.ahead == IF_NEVER else 'at most what is stated'}"

    @property
    def of_sets(self) -> str:
        """What they make of minimal cut sets and path sets since new."""
        bounds = "a probability of failing is at least, one of working at most what is stated"
        return f"{self.left_out}: {bounds}; a share is {self._free}"

    @property
    def of_costs(self) -> str:
        """What they make of a life cycle."""
        return f"{self.left_out}: costs and failures are at least, availability is at most what is stated"

    @property
    def of_shares(self) -> str:
        """What they make of the failures to come."""
        return f"{self.left_out}: shares are of the failures of parts whose rate is known"

    @property
    def aside(self) -> str:
        """What they make of figures of which only some are bounds, and say so: importances, gains, suspects."""
        return f"{self.left_out}: what is not said to be at least or at most is {self._free}"

    @property
    def _free(self) -> str:
        return f"as {self.if_never}, and may be more or less"


def unknown(outlook: Outlook, *diagrams: Block, later: bool = False) -> PartsOfUnknownRate | None:
    """Of one system, or of several that must work together; None where every rate in it is known, or wear says it.

    ``later``: the hazard rate is of survivors at another time than now.
    """
    plant = outlook.plant
    is_unknown = plant.unknown
    if seen := believed(outlook):
        told = [not any(mode.unknown and mode.path not in seen for mode in part.modes) for part in plant.components]
        is_unknown = is_unknown & ~np.array([*told, *(True for _ in plant.groups)])[plant.component_of]
    systems = [outlook.plant.system(diagram) for diagram in diagrams]
    units = {int(unit) for system in systems for unit in system.units[is_unknown[system.units]]}
    if not units:
        return None
    needed = all(system.needed[is_unknown[system.units]].all() for system in systems)
    working = needed or all(not outlook.known(system, system.needed).any() for system in systems)
    count = sum(int(plant.multiplicity[plant.component_of[unit]]) for unit in units)
    rate: Literal["at least", "if they never fail"] = "at least" if needed or (working and not later) else IF_NEVER
    return PartsOfUnknownRate(count, rate, "at most", "at most" if working else IF_NEVER)


def alone(parts: Iterable[Component]) -> PartsOfUnknownRate | None:
    """Of parts whatever they are wired to: of figures that are made of them nothing is a bound; None where all rates
    are known."""
    count = sum(part.quantity for part in parts if part.unknown)
    return PartsOfUnknownRate(count, IF_NEVER, "at most", IF_NEVER) if count else None


def named(robot: Robot) -> str:
    """The components of unknown rate, the first few by name."""
    return few([part.path for part in robot.all_components() if part.unknown])


def few(names: Sequence[str], most: int = 5) -> str:
    """The first few of many names."""
    return ", ".join(names[:most]) + (f" and {len(names) - most:,} more" if len(names) > most else "")


def marked(mark: str, text: str) -> str:
    """A figure behind its mark; "unknown" where that would say nothing: at least 0, at most for ever."""
    number = text.partition(" ")[0].partition("/")[0]
    return UNKNOWN if mark and number in ("∞", "0") else mark + text


def marks(left_out: PartsOfUnknownRate | None) -> tuple[str, str, str]:
    """What stands before a hazard rate, a survival, and what lies ahead: "≥ ", "≤ ", or "? " if they never fail."""
    if left_out is None:
        return "", "", ""
    return MARKS[left_out.hazard_rate], MARKS[left_out.reliability], MARKS[left_out.ahead]


MARKS: dict[Bound, str] = {"at least": "≥ ", "at most": "≤ ", IF_NEVER: "? "}
"""What stands before a figure."""
