"""What a robot's future hangs on: how much each unit matters, in the time ahead and in all of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.importance import Importance, barlow_proschan, importance, intensity
from robophm.blocks.merging import single_points_of_failure
from robophm.blocks.reliability import Structure
from robophm.health.plant import Parts, Plant
from robophm.health.prognosis import Outlook

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class UnitImportance:
    """How much one unit of a diagram matters, given what is known now; not a number where that says nothing.

    The measures are those of ``blocks.importance``.
    """

    unit: str
    birnbaum: float
    criticality: float
    achievement: float
    reduction: float
    improvement: float
    barlow_proschan: float
    """P(its failure is the one that fails the system | it ever fails)."""


@dataclass(frozen=True)
class Importances:
    """Of all units of a diagram, in drawing order."""

    hours: float
    """Of operation from now on, to which all but the Barlow–Proschan importances are."""
    failure: float
    """P(the system fails within them | what is known now)."""
    ever: float
    """P(it ever fails)."""
    units: tuple[UnitImportance, ...]

    def ranked(self, by: str = "criticality") -> list[UnitImportance]:
        """The most important first; those of which it is not known last."""

        def rank(one: UnitImportance) -> float:
            value = getattr(one, by)
            return math.inf if math.isnan(value) else -value

        return sorted(self.units, key=rank)


class Drawn(Parts):
    """A diagram prepared with every unit by itself, to be asked about each."""

    def __init__(self, plant: Plant, diagram: Block) -> None:
        self.structure = Structure(diagram)
        super().__init__(plant, [(name,) for name in self.structure.names])
        fatal = single_points_of_failure(diagram)
        self.needed = np.array([name in fatal for name in self.structure.names])
        """Whether the system works only while a unit does."""


def importances(outlook: Outlook, drawn: Drawn, hours: float) -> Importances:
    """How much each unit matters within so many operating hours, at the mean pace of the future, given what is known.

    Barlow–Proschan importances are of all time ahead.
    """
    known = outlook.known(drawn, drawn.needed)
    more = outlook.onward(drawn, np.array([hours]))[0][:, 0]
    chances = -np.expm1(-known), np.exp(-known) * -np.expm1(-more), np.exp(-known - more)
    system = drawn.structure.transition(*chances)
    works = float(system.fails + system.survives)
    measures = importance(drawn.structure, *chances)
    caused = np.full(len(known), math.nan)
    if works > 0:
        caused = _caused(outlook, drawn, known) / works
    ever = float(caused.sum())
    share = caused / ever if ever > 0 else np.full(len(known), math.nan)
    return Importances(
        hours,
        float(system.fails) / works if works > 0 else 1.0,
        ever if works > 0 else 1.0,
        tuple(
            UnitImportance(name, *(float(one) for one in values))
            for name, *values in zip(drawn.structure.names, *measures, share, strict=True)
        ),
    )


def _caused(outlook: Outlook, drawn: Drawn, known: Array) -> Array:
    """P(the system works now, and it is this unit that fails it, ever)."""

    def ahead(hours: Array) -> tuple[Array, Array, Array]:
        more, hazard = outlook.onward(drawn, hours)
        total = known[:, None] + more
        works = np.exp(-total)
        return works, -np.expm1(-total), hazard * works

    def curve(hours: Array) -> tuple[Array, Array]:
        more, _ = outlook.onward(drawn, hours)
        before = known[:, None]
        return drawn.structure.transition(
            -np.expm1(-before), np.exp(-before) * -np.expm1(-more), np.exp(-before - more)
        ).given_works()

    return barlow_proschan(lambda hours: intensity(drawn.structure, *ahead(hours)), curve)
