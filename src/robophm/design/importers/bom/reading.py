"""The rows of a parts list as parts: references expanded and counted, faulty rows told of, none lost."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from robophm.core.errors import DesignError
from robophm.design.importers.bom.columns import Column, ColumnMapping, PartsTable, read_table
from robophm.design.importers.bom.component import LONGEST_NAME
from robophm.design.importers.bom.kinds import NO_PARTS
from robophm.design.importers.bom.parts import Described, Recognised, recognise
from robophm.design.importers.bom.quantities import with_points
from robophm.design.importers.bom.references import ReferencesError, are_references, compressed, expand
from robophm.design.importers.bom.tables import Row
from robophm.design.naming import design_name

MOST_PARTS = 100_000
"""The most parts of one row: the limit of a component's quantity."""

MOST_REFERENCES = 1_000_000
"""The most references in all rows."""


@dataclass(frozen=True)
class RowError:
    """A cell that cannot be read; its row is left out, the others are not."""

    row: int
    column: str
    value: str
    expected: str

    def __str__(self) -> str:
        """Return the error as a sentence for people."""
        return f"row {self.row}, {self.column}: '{self.value}'; expected {self.expected}; the row is left out"


@dataclass(frozen=True)
class Note:
    """Something to know about a row, which is in the design or left out on purpose."""

    row: int
    text: str

    def __str__(self) -> str:
        """Return the note as a sentence for people."""
        return f"row {self.row}: {self.text}"


@dataclass(frozen=True)
class Part:
    """A row of the list that is a part."""

    row: int
    references: tuple[str, ...]
    quantity: int
    name: str
    """Name of the part, not yet made unique in a design."""
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
    """Notes on what is odd in rows that are taken."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """Return the columns with the meanings that they were taken for."""
        return self.table.columns


def read_parts(path: Path, mapping: ColumnMapping | None = None) -> PartsList:
    """Read a parts list: .csv, .xlsx or .ods. Raises DesignError for what is none; faulty rows are told of."""
    return _List(read_table(path, mapping)).read()


class _List:
    """Makes parts of the rows of a table."""

    def __init__(self, table: PartsTable) -> None:
        self.table = table
        self.places = {column.field: column.place for column in table.columns}
        self.headers = {column.field: column.header for column in table.columns}
        self.parts: list[Part] = []
        self.errors: list[RowError] = []
        self.left_out: list[Note] = []
        self.notes: list[Note] = []
        self.count = 0
        self.boards = 1

    def read(self) -> PartsList:
        rows = list(self.table.rows)
        self.boards = self.built(rows)
        if self.boards > 1:
            self.notes.append(Note(self.table.header_row, f"all quantities are for {self.boards} boards; one is taken"))
        for name in self.table.others:
            text = (
                f"the sheet '{name}' looks like a parts list too and is not read; a mapping with sheet: {name} reads it"
            )
            self.notes.append(Note(self.table.header_row, text))
        rows = self._told_once(rows)
        for i, row in enumerate(rows):
            ends = _SUM.match(next(cell for cell in row.cells if cell))
            if ends and not self.any_parts(rows[i:]):
                self.left_out += [
                    Note(after.number, f"{_text(after)} is below the list, no part") for after in rows[i:]
                ]
                break
            self.row(row, of_a_group=not ends and self.of_a_group(rows, i))
        for reference, places in self.twice():
            at = ", ".join(map(str, places[:5]))
            self.notes.append(
                Note(places[0], f"{reference} stands in rows {at}; each of them is taken for parts of its own")
            )
        return PartsList(self.table, tuple(self.parts), tuple(self.errors), tuple(self.left_out), tuple(self.notes))

    def _told_once(self, rows: Sequence[Row]) -> list[Row]:
        """The rows without sections that name the same parts as another: one for each, and all of a kind in one row.

        A section begins with the header, told again. Of those that name the same the shortest is taken.
        """
        starts = [0, *(i for i, row in enumerate(rows) if self._is_header(row)), len(rows)]
        sections = [rows[start:end] for start, end in pairwise(starts)]
        named = [frozenset(self._references_in(section)) for section in sections]
        taken = {named[i]: i for i in sorted(range(len(sections)), key=lambda i: -len(sections[i]))}
        found: list[Row] = []
        for i, section in enumerate(sections):
            kept = taken[named[i]]
            if named[i] and i != kept:
                text = f"rows {section[0].number} to {section[-1].number} name the same parts as those from "
                self.left_out.append(Note(section[0].number, f"{text}row {sections[kept][0].number}, which are taken"))
            else:
                found += section
        return found

    def _references_in(self, rows: Sequence[Row]) -> Iterator[str]:
        for row in rows:
            if not self._is_header(row):
                with suppress(ReferencesError):
                    yield from expand(self.cell(row, "reference"))

    def _is_header(self, row: Row) -> bool:
        """Whether a row is the header again."""
        cells = [self.cell(row, column.field) for column in self.table.columns]
        return any(cells) and all(
            cell in ("", column.header) for cell, column in zip(cells, self.table.columns, strict=True)
        )

    def built(self, rows: Sequence[Row]) -> int:
        """For how many boards the quantities are, where all of three rows and more are the same multiple."""
        times = []
        for row in rows:
            quantity = re.fullmatch(r"([0-9]{1,9})(?:\.0{1,6})?", self.cell(row, "quantity"))
            try:
                references = expand(self.cell(row, "reference"))
            except ReferencesError:
                continue
            if quantity and references and int(quantity[1]):
                times.append(int(quantity[1]) / len(references))
        return round(times[0]) if len(times) > 2 and len({*times}) == 1 and times[0].is_integer() else 1

    def cell(self, row: Row, field: str) -> str:
        at = self.places.get(field, len(row.cells))
        return row.cells[at] if at < len(row.cells) else ""

    def any_parts(self, rows: Sequence[Row]) -> bool:
        """Whether a part follows a sum: with a reference, or in a list without them with a quantity."""
        if "reference" in self.places:
            return any(are_references(self.cell(row, "reference")) for row in rows if self.cell(row, "reference"))
        return any(re.fullmatch(r"[0-9]+", self.cell(row, "quantity")) for row in rows[1:])

    def of_a_group(self, rows: Sequence[Row], i: int) -> bool:
        """Whether a row's quantity is of it and of rows below, which have none and are the same part."""
        here = rows[i]
        if not self.cell(here, "quantity") or not self.cell(here, "reference") or i + 1 == len(rows):
            return False
        below = rows[i + 1]
        alike = [name for name in ("part_number", "description", "footprint") if self.cell(here, name)] or ["value"]
        return (
            not self.cell(below, "quantity")
            and bool(self.cell(below, "reference"))
            and bool(self.cell(here, alike[0]))
            and all(self.cell(here, name) == self.cell(below, name) for name in alike)
        )

    def twice(self) -> Iterator[tuple[str, list[int]]]:
        counts = Counter(reference for part in self.parts for reference in part.references)
        rows: dict[str, list[int]] = {reference: [] for reference, count in counts.items() if count > 1}
        for part in self.parts if rows else ():
            for reference in part.references:
                if reference in rows:
                    rows[reference].append(part.row)
        yield from rows.items()

    def row(self, row: Row, *, of_a_group: bool) -> None:
        said = {field: row.cells[at] if at < len(row.cells) else "" for field, at in self.places.items()}
        said = {field: self.plain(row.number, field, cell) for field, cell in said.items()}
        described = Described(**{name: said.get(name, "") for name in Described.__dataclass_fields__})
        reference = said.get("reference", "")
        if why := self.no_part(row, said) or _not_there(said, reference or described.value or "a part"):
            self.left_out.append(Note(row.number, why))
            return
        try:
            references = expand(reference)
        except ReferencesError as error:
            self.errors.append(RowError(row.number, self.headers["reference"], reference[:80], str(error)))
            return
        self.count += len(references)
        if self.count > MOST_REFERENCES:
            raise DesignError(f"row {row.number}: more than {MOST_REFERENCES:,} references in all")
        number = self.taken(row.number, said.get("quantity", ""), references, of_a_group=of_a_group)
        if number is None:
            return
        if number == 0:
            self.left_out.append(Note(row.number, f"{reference or described.value or 'a part'} has quantity 0"))
            return
        doubled = [name for name, times in Counter(references).items() if times > 1]
        if doubled:
            self.notes.append(Note(row.number, f"{', '.join(doubled[:5])} stand several times in this row"))
        code = described.part_number if re.search(r"[A-Za-z]", described.part_number) else ""  # 938 names nothing
        words = (described.value, code, described.description, described.library, described.part_number)
        name = _short_references(references) or next(filter(None, words), "")
        recognised = recognise(references, described, self.table.decimal)
        if recognised.kind in NO_PARTS:
            self.left_out.append(Note(row.number, f"{reference or name} is no electrical part"))
            return
        named = reference or name
        self.notes += [Note(row.number, f"{named:.40}: {text}") for text in recognised.contradictions]
        self.parts.append(
            Part(
                row.number,
                references,
                number,
                design_name(name or f"row {row.number}", LONGEST_NAME),
                described,
                recognised,
            )
        )

    def no_part(self, row: Row, said: Mapping[str, str]) -> str:
        """The reason why a row is no part: the header again, a heading, a sum; '' where it is one."""
        if self._is_header(row):
            return "is the header again"
        filled = [cell for cell in said.values() if cell]
        if (
            not filled
            or _SUM.match(next(cell for cell in row.cells if cell))
            or (len(filled) == 1 and "reference" in said and not re.search(r"\d", said["reference"]))
        ):
            text = " ".join(cell for cell in row.cells if cell)
            return f"'{text:.60}' is a heading or a sum, no part"
        return ""

    def taken(self, row: int, quantity: str, references: Sequence[str], *, of_a_group: bool) -> int | None:
        """The number of parts in a row, also where its references say another; None where the quantity is none."""
        number = self.quantity(row, quantity) if quantity else len(references) or 1
        if number is None:
            return None
        if references and self.boards > 1 and number == self.boards * len(references):
            return len(references)
        ordered = "quantity" in self.headers and _ORDERED.search(self.headers["quantity"])
        if references and number > len(references) and (of_a_group or ordered):
            why = "is of this row and those of the same part below" if of_a_group else "is what is ordered"
            self.notes.append(Note(row, f"the quantity {number} {why}; {_counted(references)}, and so many are taken"))
            return len(references)
        if number and references and quantity and number != len(references):
            more = max(number, len(references))
            self.notes.append(Note(row, f"{_counted(references)}, the quantity is {number}; {more} are taken"))
            return more
        return number

    def plain(self, row: int, field: str, cell: str) -> str:
        """The text of a cell; a formula is refused, and not passed on."""
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


def _text(row: Row) -> str:
    return f"'{' '.join(cell for cell in row.cells if cell):.60}'"


def _counted(references: Sequence[str]) -> str:
    counting = "is 1 reference" if len(references) == 1 else f"are {len(references)} references"
    return f"{compressed(references):.60} {counting}"


_ORDERED = re.compile(
    r"digi-?key|mouser|lcsc|farnell|newark|arrow|reichelt|order|purchase|buy|bestell|stock|moq|minimum", re.IGNORECASE
)
"""Headers of how many are bought, and not of how many are on the board."""

_SUM = re.compile(
    r"\s*((grand |sub[- ]?)?total|sum|summe|gesamt|somme|totale|shipping|postage|versand|tax|vat|mwst)\b"
    r"(?!.*\d.*\d.*\d.*\d)",
    re.IGNORECASE,
)
_FORMULA = re.compile(r"[=@]|[+-][^\d\s.,/]*[|(!]")
_DNP = re.compile(
    r"(?<!\w)(?:dn[pfim]|do[ -]not[ -](?:populate|fit|install|mount|place|stuff)|"
    r"not[ -](?:fitted|populated|mounted|installed)|"
    r"no[ -]?pop|unpopulated|nicht bestück\w*|unbestückt|non mont[ée]e?|ne pas monter)(?!\w)",
    re.IGNORECASE,
)
_DNP_ALONE = re.compile(r"np|nf|nm|nc|n\.?b\.?|no ?fit|no ?load|dnl|dns", re.IGNORECASE)
_NO = {"", "0", "no", "n", "false", "nein", "non", "fitted", "populate", "populated", "mounted", "bestückt"}


def _not_there(said: Mapping[str, str], named: str) -> str:
    """A remark that the part of a row is not on the board, and why; '' where it is."""
    return f"{named} is not fitted ({why})" if (why := _unfitted(said)) else ""


def _unfitted(said: Mapping[str, str]) -> str:
    """The reason why a row's part is not on the board, '' where it is."""
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
