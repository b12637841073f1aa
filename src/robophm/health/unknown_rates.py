"""Parts of unknown rate: how many there are in a system, and how they make its figures bounds.

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
"""The relation of a stated figure to the true one."""


@dataclass(frozen=True)
class PartsOfUnknownRate:
    """The effect of parts of unknown rate on the figures of a system that they are in."""

    parts: int
    hazard_rate: Literal["at least", "if they never fail"]
    """Relation of the stated hazard rate to the true one."""
    reliability: Literal["at most"]
    """Relation of the stated survival since new to the true one."""
    ahead: Literal["at most", "if they never fail"]
    """Relation of the stated remaining life and task completion to the true ones."""

    @property
    def failing(self) -> Literal["at least", "if they never fail"]:
        """Return the relation of the stated probability of failing ahead to the true one."""
        return "at least" if self.ahead == "at most" else IF_NEVER

    @property
    def words(self) -> str:
        """Return how many there are, in words: "3 parts of unknown rate"."""
        return f"{self.parts:,} part{'s' * (self.parts != 1)} of {UNKNOWN} rate"

    @property
    def if_never(self) -> str:
        """Return the condition of figures that hold only then: "if they never fail"."""
        return "if it never fails" if self.parts == 1 else IF_NEVER

    def said(self, bound: Bound, text: str) -> str:
        """Return a figure in words: "at least …", "at most …", or "…, if they never fail"."""
        return f"{text}, {self.if_never}" if bound == IF_NEVER else f"{bound} {text}"

    def said_ahead(self, text: str) -> str:
        """Return a remaining life or probability of completion in words."""
        return self.said(self.ahead, text)

    @property
    def left_out(self) -> str:
        """Return the beginning of every sentence about them."""
        return f"{self.words} {'is' if self.parts == 1 else 'are'} left out of the totals"

    @property
    def sentence(self) -> str:
        """Return the sentence on the figures of health."""
        bounded = "R, remaining life and PoTC are" if self.ahead == "at most" else "R is"
        if self.hazard_rate == "at least":
            return f"{self.left_out}: λ is at least, {bounded} at most what is stated"
        free = "λ is" if self.ahead == "at most" else "λ, remaining life and PoTC are"
        return f"{self.left_out}: {bounded} at most what is stated; {free} {self._free}"

    @property
    def of_tasks(self) -> str:
        """Return the sentence on the probabilities that tasks are completed."""
        return f"{self.left_out}: every PoTC is {self._free if self.ahead == IF_NEVER else 'at most what is stated'}"

    @property
    def of_sets(self) -> str:
        """Return the sentence on minimal cut sets and path sets since new."""
        bounds = "a probability of failing is at least, one of working at most what is stated"
        return f"{self.left_out}: {bounds}; a share is {self._free}"

    @property
    def of_costs(self) -> str:
        """Return the sentence on a life cycle's costs and availability."""
        return f"{self.left_out}: costs and failures are at least, availability is at most what is stated"

    @property
    def of_shares(self) -> str:
        """Return the sentence on the failures to come."""
        return f"{self.left_out}: shares are of the failures of parts whose rate is known"

    @property
    def aside(self) -> str:
        """Return the sentence on figures of which only some are bounds, and say so: importances, gains, suspects."""
        return f"{self.left_out}: a figure without 'at least' or 'at most' is {self._free}"

    @property
    def _free(self) -> str:
        return f"as {self.if_never}, and may be more or less"


def unknown(outlook: Outlook, *diagrams: Block, later: bool = False) -> PartsOfUnknownRate | None:
    """Return the effect of unknown rates on one system, or on several that must all work; None where every rate is
    known, or wear says when its mode comes.

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


def unknown_in_parts(parts: Iterable[Component]) -> PartsOfUnknownRate | None:
    """Return the effect on figures made of parts whatever their wiring: nothing is a bound. None where all rates are
    known."""
    count = sum(part.quantity for part in parts if part.unknown)
    return PartsOfUnknownRate(count, IF_NEVER, "at most", IF_NEVER) if count else None


def named(robot: Robot) -> str:
    """Return the components of unknown rate, the first few by name."""
    return few([part.path for part in robot.all_components() if part.unknown])


def few(names: Sequence[str], most: int = 5) -> str:
    """Return the first few of many names, in words."""
    return ", ".join(names[:most]) + (f" and {len(names) - most:,} more" if len(names) > most else "")


def marked(mark: str, text: str) -> str:
    """Return a figure behind its mark; "unknown" where it would say nothing: at least 0, at most for ever."""
    number = text.partition(" ")[0].partition("/")[0]
    return UNKNOWN if mark and number in ("∞", "0") else mark + text


def marks(left_out: PartsOfUnknownRate | None) -> tuple[str, str, str]:
    """Return the marks before a hazard rate, a survival, and what lies ahead: "≥ ", "≤ ", or "? " if they never
    fail."""
    if left_out is None:
        return "", "", ""
    return MARKS[left_out.hazard_rate], MARKS[left_out.reliability], MARKS[left_out.ahead]


MARKS: dict[Bound, str] = {"at least": "≥ ", "at most": "≤ ", IF_NEVER: "? "}
"""The sign before a figure, for each relation to the truth."""
