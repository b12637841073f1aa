"""A parts list becomes a design, or part of one: every row a component, rated by what the list says of it.

What a model asks for and the list does not say is assumed, and said beside it; a part without a model, or of which too
little is known for one, is said and becomes a part of unknown rate. Nothing is dropped or guessed in silence.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from robophm.core.errors import DesignError
from robophm.core.spread import Spread
from robophm.core.units import quantity
from robophm.design.file import parse, read
from robophm.design.importers.bom.assumptions import Assumptions, TooLittle
from robophm.design.importers.bom.columns import ColumnMapping
from robophm.design.importers.bom.component import LONGEST_DESCRIPTION, LONGEST_NAME, Wanted
from robophm.design.importers.bom.kinds import is_guess
from robophm.design.importers.bom.merging import Level, Outcome, State
from robophm.design.importers.bom.models import Rater, Rating, rates
from robophm.design.importers.bom.reading import Part, PartsList, read_parts
from robophm.design.naming import design_name, printable, quoted
from robophm.design.robot import Robot
from robophm.hazard.environments import explained
from robophm.hazard.qualities import QUALITIES, UNKNOWN
from robophm.hazard.qualities import quality as quality_of_board


@dataclass(frozen=True)
class ImportedPart:
    """One part of a parts list, with its rating and what became of it in the design."""

    part: Part
    rating: Rating | None
    hazard_rate: float | None
    """Hazard rate of one of these parts as the list gives it [1/h]; None where it has no rate.

    Where its quality is unknown it is the mean of what it may be.
    """
    outcome: Outcome

    @property
    def guess(self) -> bool:
        """Whether it is rated as what nothing but its letters, its value or a doubtful word says."""
        return self.rating is not None and is_guess(self.part.recognised.concluded.get("kind", ""))


@dataclass(frozen=True)
class ImportedList:
    """A design with the parts of a list in it."""

    text: str
    robot: Robot
    parts_list: PartsList
    assumptions: Assumptions
    parts: tuple[ImportedPart, ...]
    removed: tuple[Outcome, ...]
    """Parts of an earlier import of this list that it no longer has; those that stay are 'kept'."""

    @property
    def guesses(self) -> list[ImportedPart]:
        """The parts that are rated as what is a guess."""
        return [one for one in self.parts if one.guess]

    def of_state(self, state: State) -> list[ImportedPart]:
        """Return the parts that ended in this state."""
        return [one for one in self.parts if one.outcome.state == state]


def total_rate(parts: Iterable[ImportedPart]) -> float:
    """Return the hazard rate of parts in series when new [1/h], as the list gives them; unrated ones add nothing."""
    return math.fsum(one.part.quantity * one.hazard_rate for one in parts if one.hazard_rate is not None)


def rate_range(parts: Iterable[ImportedPart]) -> tuple[float, float]:
    """Return what the hazard rate of parts in series may be by an unknown quality [1/h]: its 5 and 95 % quantiles.

    All parts are as good as the best may be, or all as bad as the worst. Both are the total rate where it is stated.
    """
    rated = [(one.part.quantity * one.hazard_rate, one.rating) for one in parts if one.hazard_rate is not None]
    spreads = [(rate, one.spread if one and one.spread else Spread(1.0, 1.0)) for rate, one in rated]
    return math.fsum(rate / one.mean * one.low for rate, one in spreads), math.fsum(
        rate / one.mean * one.high for rate, one in spreads
    )


def by_kind(parts: Iterable[ImportedPart]) -> dict[str, list[ImportedPart]]:
    """Return the parts by kind, the kinds in the order of their names; "" for those whose kind is not clear."""
    found: dict[str, list[ImportedPart]] = {}
    for one in parts:
        found.setdefault(one.part.recognised.kind, []).append(one)
    return dict(sorted(found.items()))


def assumed_inputs(parts: Iterable[ImportedPart]) -> dict[str, Counter[str]]:
    """Return, for inputs of models that a list does not state, how many rows take which value."""
    found: dict[str, Counter[str]] = {}
    for rating in filter(None, (one.rating for one in parts)):
        for name in rating.assumed:
            found.setdefault(name, Counter())[rating.inputs.get(name, rating.model)] += 1
    return found


def rate_parts(parts: Sequence[Part], assumptions: Assumptions) -> list[tuple[Rating | None, float | None, str]]:
    """Return the model and inputs of each part with its hazard rate [1/h], or why it has none."""
    rater = Rater(assumptions)
    found: list[tuple[Rating | None, str]] = []
    for part in parts:
        try:
            found.append((rater.rating(part.recognised), ""))
        except TooLittle as reason:
            found.append((None, str(reason)))
    values = iter(rates([rating for rating, _ in found if rating]).tolist())
    return [(rating, next(values) if rating else None, why) for rating, why in found]


def import_bom(
    source: Path,
    design: Path,
    *,
    mapping: ColumnMapping | None = None,
    assumptions: Assumptions | None = None,
    environment: str | None = None,
    module: Sequence[str] = (),
) -> ImportedList:
    """Put the parts of a list into a design, a new one where there is no such file; nothing is written.

    ``environment`` is that of the design's level, or GM, unless it is given. Raises DesignError.
    """
    assumed = assumptions or Assumptions()
    quantity(assumed.temperature, "degC")
    if not 0 <= assumed.stress <= 1:
        raise DesignError(f"stress {assumed.stress:g}; expected a share of the rated one, 0 to 1")
    found = read_parts(source, mapping)
    there = design.exists()
    text = read(design) if there else f"schema_version: 1\nname: {quoted(design_name(design.stem, LONGEST_NAME))}\n"
    if there:
        parse(text, str(design))
    level = Level(text, str(design), module)
    stated = level.environment and replace(assumed, environment=level.environment).environment
    assumed = replace(assumed, environment=environment or stated or Assumptions.environment)
    wished, there_stated = assumed.quality, level.quality
    if wished is None and there_stated is None and not level.rated:
        wished = UNKNOWN  # nobody has said it, and no part there has been rated as if somebody had
    board = wished.casefold() if wished and wished.casefold() in QUALITIES else None
    if board and (there_stated in (None, board) or level.own_quality == UNKNOWN):  # said once, for the whole level
        assumed = replace(assumed, quality=None, board_quality=board)
    else:
        assumed = replace(assumed, board_quality=there_stated and quality_of_board(there_stated))
    own_environment = assumed.environment if stated and stated != assumed.environment else None
    rated = rate_parts(found.parts, assumed)
    file = printable(source.name)
    wanted = [_wanted(part, *rating, own_environment) for part, rating in zip(found.parts, rated, strict=True)]
    quality = assumed.quality or assumed.board_quality or "each model's default, its lowest or commercial"
    remarks = (
        f"{file:.80}; where it says nothing else, assumed are: temperature {assumed.temperature},",
        f"junctions and windings {assumed.rise} above it, voltage, current and power {assumed.stress:g} of the rated,",
        f"environment {explained(assumed.environment)},",
        f"quality {quality}.",
    )
    result = level.merge(
        wanted, file=file, environment=assumed.environment, quality=assumed.board_quality, remarks=remarks
    )
    robot = parse(result.text, str(design) if there else f"{source}, as a design")
    parts = tuple(
        ImportedPart(part, one.rating, one.hazard_rate, outcome)
        for part, one, outcome in zip(found.parts, wanted, result.outcomes, strict=True)
    )
    return ImportedList(result.text, robot, found, assumed, parts, tuple(result.removed))


def _wanted(part: Part, rating: Rating | None, rate: float | None, why: str, environment: str | None) -> Wanted:
    if rating and environment and "environment" in rating.settled:
        rating = replace(rating, inputs={**rating.inputs, "environment": environment})
    said = part.described
    words = ", ".join(dict.fromkeys(filter(None, (said.value, said.footprint, said.description, said.part_number))))
    description = printable(words)[:LONGEST_DESCRIPTION] or part.name
    return Wanted(part.row, part.name, part.references, part.quantity, description, rating, why, rate)
