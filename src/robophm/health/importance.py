"""Importance of each unit of a robot: how much the system's failure hangs on it, in the time ahead and in all of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.fussell_vesely import fussell_vesely
from robophm.blocks.given_it_works import FAINTEST, StructureGivenItWorks, as_decimals, decimals
from robophm.blocks.given_it_works import chances as of_hazards
from robophm.blocks.importance import AT_ONCE, barlow_proschan, importance
from robophm.blocks.reliability import Structure
from robophm.blocks.single_points import single_points_of_failure
from robophm.blocks.top_event import TopEvent
from robophm.core.errors import StructureError
from robophm.health.plant import Parts, Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown

Array = npt.NDArray[np.float64]


USUAL = 1000.0
"""Hours of operation ahead that are asked about unless said otherwise."""

LONGEST = 1e9
"""Hours of operation ahead that may be asked about."""


@dataclass(frozen=True)
class UnitImportance:
    """The importance of one unit of a diagram, given what is known now; not a number where that says nothing.

    The measures are those of ``blocks.importance``.
    """

    unit: str
    birnbaum: float
    criticality: float
    fussell_vesely: float
    """P(a minimal cut set with the unit in it has failed | the system fails)."""
    achievement: float
    reduction: float
    improvement: float
    barlow_proschan: float
    """P(its failure is the one that fails the system | it ever fails)."""


@dataclass(frozen=True)
class Importances:
    """The importances of all units of a diagram, in drawing order."""

    hours: float
    """Hours of operation from now on, to which all but the Barlow–Proschan importances refer."""
    failure: float
    """P(the system fails within them | what is known now)."""
    ever: float
    """P(the system ever fails), the sum of the Barlow–Proschan importances."""
    units: tuple[UnitImportance, ...] = field(repr=False)
    refused: str = ""
    """The reason why there are no Fussell–Vesely importances, where there are none."""
    unknown: PartsOfUnknownRate | None = None
    """The effect of parts of unknown rate, which are left out: their importances are as if they never failed."""

    @property
    def has_failed(self) -> bool:
        """Whether the system has failed as far as is known: no unit matters more than another."""
        return math.isnan(self.units[0].birnbaum)

    @property
    def lifelong(self) -> bool:
        """Whether there are Barlow–Proschan importances, which are of all time ahead."""
        return not math.isnan(self.ever)

    def ranked(self, by: str = "criticality") -> list[UnitImportance]:
        """Return the units, the most important first; those of unknown importance come last."""

        def rank(one: UnitImportance) -> float:
            value = getattr(one, by)
            return math.inf if math.isnan(value) else -value

        return sorted(self.units, key=rank)


def usual_hours(outlook: Outlook, median: float) -> float:
    """Return the hours of operation to ask about by default: USUAL, or half of the median remaining life [h] if
    shorter."""
    half = median * outlook.plant.robot.usage.operating
    return min(half, USUAL) if half > 0 else USUAL


LIFELONG = 20_000
"""Units up to which a page states Barlow–Proschan importances too, in a second or two."""


class Drawn(Parts):
    """A diagram prepared with every unit by itself, to be asked about each."""

    def __init__(self, plant: Plant, diagram: Block) -> None:
        self.diagram, self.structure = diagram, Structure(diagram)
        self.conditional = StructureGivenItWorks(diagram, structure=self.structure)
        super().__init__(plant, [(name,) for name in self.structure.names])
        fatal = single_points_of_failure(diagram)
        self.needed = np.array([name in fatal for name in self.structure.names])
        """Whether the system works only while a unit does."""


def importances(outlook: Outlook, drawn: Drawn, hours: float, *, lifelong: bool = True) -> Importances:
    """Return how much each unit matters within operating hours, at the future's mean pace, given what is known.

    Barlow–Proschan importances are of all time ahead, and take most of the work: they are left out if not ``lifelong``.
    """
    known = outlook.known(drawn, drawn.needed)
    more = _added(outlook, drawn, np.array([hours]))[:, 0]
    works = float(drawn.conditional.log_works(known))
    caused = np.full(len(known), math.nan)
    if works > -math.inf and lifelong:
        caused = _caused(outlook, drawn, known)
    ever = float(caused.sum()) if works > -math.inf else 1.0
    share = caused / ever if ever > 0 else caused
    failure = float(drawn.conditional.ahead(known, more)[0])
    with decimals():
        chances = of_hazards(*_numbers(works, known, more))
        found = _stated(drawn.diagram, drawn.structure, chances, share, hours, failure, ever)
    return replace(found, unknown=unknown(outlook, drawn.diagram))


def of_tree(event: TopEvent, hours: float = math.nan) -> Importances:
    """Return the importances of the events of a fault tree, from their probabilities.

    In one with "not" or "xor" those of an event whose failure is for the better are negative, and Fussell–Vesely's, of
    minimal cut sets, are not stated. Raises StructureError where it is too large to solve exactly.
    """
    tree = event.tree
    if not tree.coherent:
        return _of_either_way(event, hours)
    diagram = tree.diagram()
    structure = Structure(diagram)
    place = {name: i for i, name in enumerate(tree.names)}
    order = [place[name] for name in structure.names]
    failed, works = event.occurred[order], event.not_yet[order]
    failure = float(structure.probability(works, failed)[1])
    nothing = np.full(len(order), math.nan)
    return _stated(diagram, structure, (np.zeros(len(order)), failed, works), nothing, hours, failure, math.nan)


def _of_either_way(event: TopEvent, hours: float) -> Importances:
    """Importances in a tree that is not coherent: of the top event with each event given, and without it."""
    n, whole = len(event.tree.names), event.probability
    given = np.empty((2, n))
    turn = max(1, AT_ONCE // n)
    for start in range(0, n, turn):
        some = np.arange(start, min(start + turn, n))
        for i, (occurred, not_yet) in enumerate(((0.0, 1.0), (1.0, 0.0))):
            p, q = (np.repeat(one[:, None], len(some), axis=1) for one in (event.occurred, event.not_yet))
            p[some, some - start], q[some, some - start] = occurred, not_yet
            given[i, some] = event.tree.probability(p, q)
    without, sure = given
    nothing = np.full(n, math.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        columns = (sure - without, event.occurred * (sure - without) / whole, nothing, sure / whole, whole / without,
                   whole - without, nothing)  # fmt: skip
    units = zip(event.tree.names, *columns, strict=True)
    refused = "it is of minimal cut sets, which a tree with 'not' or 'xor' has none of"
    return Importances(
        hours, whole, math.nan, tuple(UnitImportance(name, *map(float, values)) for name, *values in units), refused
    )


def _stated(
    diagram: Block, structure: Structure, chances: tuple[Array, Array, Array], share: Array,
    hours: float, failure: float, ever: float,
) -> Importances:  # fmt: skip
    measures = importance(structure, *chances)
    refused, by_cut_sets = "", np.full(len(share), math.nan)
    try:
        by_cut_sets = fussell_vesely(diagram, *chances)
    except StructureError as error:
        refused = str(error)
    columns = (measures.birnbaum, measures.criticality, by_cut_sets, *measures[2:], share)
    units = zip(structure.names, *columns, strict=True)
    return Importances(
        hours, failure, ever, tuple(UnitImportance(name, *map(float, values)) for name, *values in units), refused
    )


def _numbers(works: float, *of_units: Array) -> Sequence[Array]:
    """The arrays unchanged; as decimals where ln P(works now) is so low that floats would lose digits."""
    return of_units if works > math.log(FAINTEST) else [as_decimals(one) for one in of_units]


def _caused(outlook: Outlook, drawn: Drawn, known: Array) -> Array:
    """P(it is this unit that fails the system, ever), given that it works now."""

    def rates(hours: Array) -> Array:
        hazard = outlook.hazard_then(drawn, *outlook.paced(hours))
        return hazard * drawn.conditional.hangs(known[:, None], _added(outlook, drawn, hours))

    def curve(hours: Array) -> tuple[Array, Array]:
        return drawn.conditional.ahead(known[:, None], _added(outlook, drawn, hours))

    return barlow_proschan(rates, curve)


def _added(outlook: Outlook, drawn: Drawn, hours: Array) -> Array:
    """The cumulative hazard that operating hours add to each unit; shape (units, hours)."""
    advance, effective = outlook.paced(hours)
    return outlook.gathered(drawn, advance[:, None], effective[:, None])[:, 0]
