"""A parts list becomes a design, or part of one: every row a component, rated where enough is known of it.

Nothing is invented: a part without a model, or of which too little is known, is said and left to be rated by hand.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from robophm.core.errors import DesignError
from robophm.core.units import quantity
from robophm.design.bom.columns import Column, ColumnMapping, PartsTable, read_table
from robophm.design.bom.models import Assumptions, Rater, Rating, TooLittle, rates
from robophm.design.bom.parts import Described, Recognised, recognise, with_points
from robophm.design.bom.references import ReferencesError, compressed, expand
from robophm.design.bom.tables import Row
from robophm.design.bom.writing import (
    LONGEST_DESCRIPTION,
    LONGEST_NAME,
    Merged,
    Outcome,
    Wanted,
    environment_of,
    merged,
)
from robophm.design.file import parse, read
from robophm.design.robot import Robot

MOST_PARTS = 100_000
"""Of one row: what a component's quantity may be."""

MOST_REFERENCES = 1_000_000
"""In all rows."""


@dataclass(frozen=True)
class RowError:
    """A cell that cannot be read; its row is left out, the others are not."""

    row: int
    column: str
    value: str
    expected: str

    def __str__(self) -> str:
        """For people."""
        return f"row {self.row}, {self.column}: '{self.value}'; expected {self.expected}; the row is left out"


@dataclass(frozen=True)
class Note:
    """Something to know about a row, which is in the design or left out on purpose."""

    row: int
    text: str

    def __str__(self) -> str:
        """For people."""
        return f"row {self.row}: {self.text}"


@dataclass(frozen=True)
class Part:
    """A row that is a part."""

    row: int
    references: tuple[str, ...]
    quantity: int
    name: str
    """Without what makes it unique in a design."""
    described: Described
    recognised: Recognised


@dataclass(frozen=True)
class PartsList:
    """A parts list, read."""

    table: PartsTable
    parts: tuple[Part, ...]
    errors: tuple[RowError, ...]
    left_out: tuple[Note, ...]
    """Rows that are no fitted parts: DNP, quantity 0, headings, sums."""
    notes: tuple[Note, ...]
    """What is odd in rows that are taken."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """What each column was taken for."""
        return self.table.columns


@dataclass(frozen=True)
class ImportedPart:
    """What became of a part."""

    part: Part
    rating: Rating | None
    hazard_rate: float | None
    """Of one of them, as the list gives it [1/h]; None where it has no rate."""
    outcome: Outcome


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


def read_parts(path: Path, mapping: ColumnMapping | None = None) -> PartsList:
    """Read a parts list: .csv, .xlsx or .ods. Raises DesignError for what is none; faulty rows are told of."""
    return _List(read_table(path, mapping)).read()


def rate_parts(parts: Sequence[Part], assumptions: Assumptions) -> list[tuple[Rating | None, float | None, str]]:
    """Model and inputs of each part with its hazard rate [1/h], or why it has none."""
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
    _check(assumptions or Assumptions())
    found = read_parts(source, mapping)
    there = design.exists()
    text = read(design) if there else f"schema_version: 1\nname: {_new_name(design)}\n"
    if there:
        parse(text, str(design))
    stated = environment_of(text, str(design), module)
    assumed = replace(assumptions or Assumptions(), environment=environment or stated or Assumptions.environment)
    file = _printable(source.name)
    wanted = []
    rated = rate_parts(found.parts, assumed)
    for part, (rating, rate, why) in zip(found.parts, rated, strict=True):
        if rating and stated and stated != assumed.environment:
            rating = replace(rating, inputs={**rating.inputs, "environment": assumed.environment})
        said = part.described
        words = ", ".join(dict.fromkeys(filter(None, (said.value, said.footprint, said.description, said.part_number))))
        description = _printable(words)[:LONGEST_DESCRIPTION] or part.name
        wanted.append(Wanted(part.row, part.name, part.references, part.quantity, description, rating, why, rate))
    quality = assumed.quality or "each model's default, its lowest or commercial"
    remarks = (
        f"{file:.80}; where it says nothing else, assumed are: temperature {assumed.temperature},",
        f"junctions and windings {assumed.rise} above it, voltage and power {assumed.stress:g} of the rated,",
        f"environment {assumed.environment}, quality {quality}.",
    )
    result: Merged = merged(
        text, str(design), module, wanted, file=file, environment=assumed.environment, remarks=remarks
    )
    robot = parse(result.text, str(design) if there else f"{source}, as a design")
    parts = tuple(
        ImportedPart(part, one.rating, one.hazard_rate, outcome)
        for part, one, outcome in zip(found.parts, wanted, result.outcomes, strict=True)
    )
    return ImportedList(result.text, robot, found, assumed, parts, tuple(result.removed))


def _check(assumed: Assumptions) -> None:
    """Raises UnitError or DesignError."""
    quantity(assumed.temperature, "degC")
    if not 0 <= assumed.stress <= 1:
        raise DesignError(f"stress {assumed.stress:g}; expected a share of the rated one, 0 to 1")


def _new_name(design: Path) -> str:
    from robophm.design.bom.writing import quoted

    return quoted(_name(design.stem))


class _List:
    """From the rows of a table to parts."""

    def __init__(self, table: PartsTable) -> None:
        self.table = table
        self.places = {column.field: column.place for column in table.columns}
        self.headers = {column.field: column.header for column in table.columns}
        self.parts: list[Part] = []
        self.errors: list[RowError] = []
        self.left_out: list[Note] = []
        self.notes: list[Note] = []
        self.count = 0

    def read(self) -> PartsList:
        for row in self.table.rows:
            self.row(row)
        for reference, rows in self.twice():
            at = ", ".join(map(str, rows[:5]))
            self.notes.append(
                Note(rows[0], f"{reference} stands in rows {at}; each of them is taken for parts of its own")
            )
        return PartsList(self.table, tuple(self.parts), tuple(self.errors), tuple(self.left_out), tuple(self.notes))

    def twice(self) -> Iterator[tuple[str, list[int]]]:
        counts = Counter(reference for part in self.parts for reference in part.references)
        rows: dict[str, list[int]] = {reference: [] for reference, count in counts.items() if count > 1}
        for part in self.parts if rows else ():
            for reference in part.references:
                if reference in rows:
                    rows[reference].append(part.row)
        yield from rows.items()

    def row(self, row: Row) -> None:
        said = {field: row.cells[at] if at < len(row.cells) else "" for field, at in self.places.items()}
        said = {field: self.plain(row.number, field, cell) for field, cell in said.items()}
        if all(said[column.field] in ("", column.header) for column in self.table.columns) and any(said.values()):
            self.left_out.append(Note(row.number, "is the header again"))
            return
        filled = [cell for cell in said.values() if cell]
        reference, count = said.get("reference", ""), said.get("quantity", "")
        if (
            not filled
            or _SUM.match(next(cell for cell in row.cells if cell))
            or (len(filled) == 1 and "reference" in said and not re.search(r"\d", reference))
        ):
            text = " ".join(cell for cell in row.cells if cell)
            self.left_out.append(Note(row.number, f"'{text:.60}' is a heading or a sum, no part"))
            return
        described = Described(**{name: said.get(name, "") for name in Described.__dataclass_fields__})
        if why := _unfitted(said):
            self.left_out.append(Note(row.number, f"{reference or described.value or 'a part'} is not fitted ({why})"))
            return
        try:
            references = expand(reference)
        except ReferencesError as error:
            self.errors.append(RowError(row.number, self.headers["reference"], reference[:80], str(error)))
            return
        self.count += len(references)
        if self.count > MOST_REFERENCES:
            raise DesignError(f"row {row.number}: more than {MOST_REFERENCES:,} references in all")
        number = self.quantity(row.number, count) if count else len(references) or 1
        if number is None:
            return
        if number == 0:
            self.left_out.append(Note(row.number, f"{reference or described.value or 'a part'} has quantity 0"))
            return
        if references and count and number != len(references):
            more = max(number, len(references))
            counted = f"{compressed(references):.60} are {len(references)} references"
            self.notes.append(Note(row.number, f"{counted}, the quantity is {number}; {more} are taken"))
            number = more
        doubled = [name for name, times in Counter(references).items() if times > 1]
        if doubled:
            self.notes.append(Note(row.number, f"{', '.join(doubled[:5])} stand several times in this row"))
        name = _short_references(references) or described.value or described.part_number or described.description
        recognised = recognise(references, described, self.table.decimal)
        self.parts.append(
            Part(row.number, references, number, _name(name or f"row {row.number}"), described, recognised)
        )

    def plain(self, row: int, field: str, cell: str) -> str:
        """A cell's text; a formula is none, and is not passed on."""
        if literal := re.fullmatch(r'="([^"]*)"', cell):  # how 0603 is kept from becoming 603
            return literal[1]
        if _FORMULA.match(cell):
            self.notes.append(Note(row, f"{self.headers[field]}: '{cell:.60}' is a formula, which counts as nothing"))
            return ""
        return "" if cell in ("~", "-", "–", "n/a", "N/A") else cell

    def quantity(self, row: int, cell: str) -> int | None:
        text = with_points(cell, self.table.decimal)
        match = re.fullmatch(
            r"[x×]?\s?([0-9]{1,9})(?:\.0{1,6})?\s?(?:x|×|pcs?\.?|pieces|stk\.?|st\.?|stück|ea\.?|pz\.?)?",
            text,
            re.IGNORECASE,
        )
        if match and int(match[1]) <= MOST_PARTS:
            return int(match[1])
        self.errors.append(
            RowError(row, self.headers["quantity"], cell[:80], f"a whole number from 0 to {MOST_PARTS:,}")
        )
        return None


_SUM = re.compile(r"\s*(total|sum|summe|gesamt|somme|totale)\b(?!.*\d.*\d.*\d.*\d)", re.IGNORECASE)
_FORMULA = re.compile(r"[=@]|[+-][^\d\s.,/]*[|(!]")
_DNP = re.compile(
    r"(?<!\w)(?:dn[pfim]|do[ -]not[ -](?:populate|fit|install|mount|place|stuff)|"
    r"not[ -](?:fitted|populated|mounted|installed)|"
    r"no[ -]?pop|unpopulated|nicht bestück\w*|unbestückt|non mont[ée]e?|ne pas monter)(?!\w)",
    re.IGNORECASE,
)
_DNP_ALONE = re.compile(r"np|nf|nm|nc|n\.?b\.?|no ?fit|no ?load|dnl|dns", re.IGNORECASE)
_NO = {"", "0", "no", "n", "false", "nein", "non", "fitted", "populate", "populated", "mounted", "bestückt"}


def _unfitted(said: Mapping[str, str]) -> str:
    """Why a row's part is not on the board, '' where it is."""
    flag = said.get("unfitted", "").casefold()
    if flag not in _NO:
        return f"{said['unfitted']:.40}"
    fitted = said.get("fitted", "").casefold()
    if fitted in {"no", "n", "0", "false", "nein", "non"} or _DNP.search(fitted) or _DNP_ALONE.fullmatch(fitted):
        return f"{said['fitted']:.40}"
    for name in ("value", "note", "description", "library", "part_number"):
        cell = said.get(name, "")
        if _DNP.search(cell) or (name in ("value", "note") and _DNP_ALONE.fullmatch(cell)):
            return f"{cell:.40}"
    return ""


def _short_references(references: tuple[str, ...]) -> str:
    text = compressed(references[:200])
    if len(text) <= 24:
        return text
    return f"{references[0]} … {references[-1]}"


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else " " for letter in text)


def _name(text: str) -> str:
    """A name as near to a text as a design allows."""
    return _printable(text).translate(str.maketrans("/[]", "-()")).strip()[:LONGEST_NAME].strip() or "unnamed"
