"""The meaning of a parts list's columns: guessed from header and cells, or stated in a mapping file."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Literal

from robophm.core.errors import DesignError, nearest
from robophm.design.importers.bom.references import are_references
from robophm.design.importers.bom.sheets import SheetError
from robophm.design.importers.bom.tables import DELIMITERS, Row, Sheet, read_sheets

HEADER_WITHIN = 50
"""Rows, blank ones not counted, within which a header is looked for; what stands before it is titles."""

FIELDS: Mapping[str, tuple[str, ...]] = {
    # The first names are the surest. KiCad, Altium, Eagle and OrCAD say them, and lists in German, French, Spanish.
    "reference": (
        "reference", "references", "reference(s)", "designator", "designators", "refdes", "ref des", "ref", "refs",
        "reference designator", "reference designators", "ref designator", "parts", "part reference", "part references",
        "schematic reference", "bezeichner", "referenz", "referenzen", "bauteilreferenz", "repère", "repères",
        "référence", "références", "referencia", "referencias", "riferimento", "riferimenti", "position", "pos", "part",
    ),
    "quantity": (
        "quantity", "qty", "qnty", "quantity per pcb", "qty per board", "quantities", "qté", "quantité", "menge",
        "anzahl", "stückzahl", "stück", "cantidad", "quantità", "total used", "qty used", "qty needed", "needed",
        "per board", "per robot", "count", "amount", "pcs",
    ),
    "value": (
        "value", "val", "wert", "valeur", "valor", "valore", "comment", "designation", "part value", "device value",
        "nennwert", "name",
    ),
    "footprint": (
        "footprint", "package", "pattern", "pcb footprint", "case", "case/package", "package/case", "bauform",
        "gehäuse", "boîtier", "boitier", "empreinte", "encapsulado", "huella", "contenitore", "size", "land pattern",
    ),
    "description": (
        "description", "desc", "part description", "beschreibung", "bezeichnung", "benennung", "désignation",
        "descripción", "descrizione", "details", "libdescription", "comment",
    ),
    "library": (
        "libref", "lib ref", "libpart", "library part", "library ref", "library reference", "device", "cmp name",
        "part name", "symbol", "component", "type", "typ", "category", "part type", "kategorie", "bauteil",
        "bauteiltyp", "tipo",
    ),
    "part_number": (
        "mpn", "manufacturer part number", "manufacturer part", "manufacturer part #", "manufacturer_part_number",
        "mfr part number", "mfr part", "mfg part number", "mfr. part #", "mfr no", "manufacturer pn", "manufacturer_pn",
        "part number", "part no", "herstellernummer", "hersteller-nr.", "herstellerteilenummer", "bestellnummer",
        "référence fabricant", "manf#", "mfr#", "mfg#", "manf part", "mfr. part number", "mfg. part number", "mfg part",
        "order number", "order code", "supplier and ref",
    ),
    "manufacturer": (
        "manufacturer", "mfr", "mfg", "manf", "manufacturer name", "hersteller", "fabricant", "fabricante",
        "produttore", "vendor",
    ),
    "voltage": ("voltage", "rated voltage", "voltage rating", "spannung", "nennspannung", "tension", "voltaje"),
    "tolerance": ("tolerance", "tol", "toleranz", "tolérance", "tolerancia"),
    "power": ("power", "power rating", "rated power", "leistung", "nennleistung", "puissance", "wattage"),
    "material": ("dielectric", "material", "temperature coefficient", "technology", "dielektrikum", "diélectrique"),
    "fitted": (
        "fitted", "populate", "populated", "mounted", "assemble", "assembly", "placed", "mount", "bestückt",
        "bestückung", "monté",
    ),
    "unfitted": (
        "dnp", "dnf", "dni", "do not populate", "do not fit", "do not place", "do not install", "do not mount",
        "not fitted", "nicht bestückt", "non monté", "exclude from bom",
    ),
    "note": ("note", "notes", "remark", "remarks", "bemerkung", "remarque", "comments", "comment", "config", "variant"),
}  # fmt: skip
"""The meanings that a column can have, and the headers that state them."""

Decimal = Literal[",", "."]


@dataclass(frozen=True)
class Column:
    """A column of the list, and how sure it is that it means this field."""

    field: str
    header: str
    place: int
    confidence: float
    """1 where a mapping file says so or a usual header does, less where a similar header or the cells do."""


@dataclass(frozen=True)
class PartsTable:
    """A list whose columns are known."""

    sheet: str
    header_row: int
    columns: tuple[Column, ...]
    unused: tuple[str, ...]
    """Headers that mean nothing here."""
    decimal: Decimal
    rows: tuple[Row, ...]
    titles: int
    """Rows before the header."""
    others: tuple[str, ...] = ()
    """Further sheets of a workbook that look like parts lists; they are not read."""


@dataclass(frozen=True)
class ColumnMapping:
    """The columns and the decimal sign that a mapping file states."""

    columns: Mapping[str, str]
    decimal: Decimal | None = None
    sheet: str | None = None
    """The name of the sheet to read from a workbook; None for the sheet whose header is understood best."""


def read_table(path: Path, said: ColumnMapping | None = None) -> PartsTable:
    """The rows of a parts list below its header. Raises DesignError where no header is found, or none as said."""
    try:
        return _chosen(path, said or ColumnMapping({}))
    except SheetError as error:
        raise DesignError(f"{path}: {error}") from None


def _chosen(path: Path, said: ColumnMapping) -> PartsTable:
    """The sheet, or delimiter, and the row in it that are best understood as a header."""
    best: tuple[float, Sheet, Row, list[Column]] | None = None
    seen: Row | None = None
    fault: SheetError | None = None
    lists: dict[str, None] = {}
    sheets = read_sheets(path)
    if said.sheet is not None and said.sheet not in (names := [sheet.name for sheet in sheets]):
        raise SheetError(f"has no sheet '{said.sheet}', which the mapping names{nearest(said.sheet, names)}")
    for sheet in sheets if said.sheet is None else [one for one in sheets if one.name == said.sheet]:
        try:
            head = list(islice(sheet.rows(), HEADER_WITHIN))
        except SheetError as error:  # a quotation mark that only another delimiter understands
            fault = fault or error
            continue
        for i, row in enumerate(head):
            columns = _columns(row.cells, head[i + 1 :], said)
            score = sum(column.confidence for column in columns)
            if {"reference", "value", "part_number"} & {column.field for column in columns} and len(columns) > 2:
                lists[sheet.name] = None
            if best is None or score > best[0] + _MARGIN:
                best = score, sheet, row, columns
            if seen is None or len(row.cells) > len(seen.cells):
                seen = row
    if best is None:
        raise fault or SheetError("holds no rows; expected a parts list")
    _, sheet, header, columns = best
    fields = {column.field for column in columns}
    for field, name in said.columns.items():
        if field not in fields:
            known = seen.cells if seen else ()
            raise SheetError(f"has no column '{name}', which the mapping names for {field}{nearest(name, known)}")
    if len(fields) < 2 or not fields & {"reference", "quantity", "value", "part_number"}:
        if fault:
            raise fault
        found = ", ".join(repr(cell[:30]) for cell in (seen.cells if seen else ())[:8])
        raise SheetError(f"has no header with e.g. Reference, Quantity, Value, Footprint; found {found}; say which "
                         "columns they are in a mapping file")  # fmt: skip
    header = next(row for row in sheet.rows() if row.cells == header.cells)  # which may be told again further down
    rows = tuple(row for row in sheet.rows() if row.number > header.number)
    titles = sum(1 for row in islice(sheet.rows(), HEADER_WITHIN) if row.number < header.number)
    places = {column.place for column in columns}
    unused = tuple(cell for i, cell in enumerate(header.cells) if cell and i not in places)
    semicolons = sheet.name == DELIMITERS[";"]
    written = sheet.name in DELIMITERS.values()  # and not numbers of a workbook, which have points in all countries
    places_with_numbers = [column.place for column in columns if column.field in _WITH_NUMBERS]
    decimal = said.decimal or _decimal(rows, places_with_numbers, semicolons, written)
    others = tuple(name for name in lists if name != sheet.name and not written)
    return PartsTable(sheet.name, header.number, tuple(columns), unused, decimal, rows, titles, others)


_MARGIN = 0.3
"""Confidence by which a later row must be the better header: some lists repeat theirs."""


def _columns(header: tuple[str, ...], below: list[Row], said: ColumnMapping) -> list[Column]:
    """The columns that the cells of a row would be as a header, each field once, each column once."""
    found = [
        Column(field, header[place], place, 2.0)
        for field, name in said.columns.items()
        for place in range(len(header))
        if _folded(header[place]) == _folded(name)
    ]
    taken_fields = set(said.columns)
    claims: list[Column] = []
    for place, cell in enumerate(header):
        if not 0 < len(cell) <= 60:
            continue
        for words in {_folded(cell), _folded(re.sub(r"(?<=[a-z])(?=[A-Z])", " ", cell))}:  # PartNum is two words
            claims += [Column(field, cell, place, one) for field, one in _meanings(words) if field not in taken_fields]
    claims += [claim for claim in _by_cells(header, below) if claim.field not in taken_fields]
    claims = [_checked(claim, below) for claim in claims]
    taken_places = {column.place for column in found}
    for claim in sorted(claims, key=lambda claim: (-claim.confidence, claim.place)):
        if claim.confidence > 0 and claim.field not in taken_fields and claim.place not in taken_places:
            taken_fields.add(claim.field)
            taken_places.add(claim.place)
            found.append(claim)
    if not any(column.confidence >= 0.6 for column in found):
        return []
    return sorted(
        (Column(c.field, c.header, c.place, round(min(c.confidence, 1.0), 2)) for c in found), key=lambda c: c.place
    )


def _folded(text: str) -> str:
    text = re.sub(r"(?<=\w)\s*#", " number", unicodedata.normalize("NFC", text).casefold()).replace("_", " ")
    return " ".join(re.sub(r"\bnum\b", "number", text.strip(" :*#.\"'")).split())


_EXACT = {
    (field, _folded(name)): 1.0 - 0.004 * rank for field, names in FIELDS.items() for rank, name in enumerate(names)
}
_SHARED = {
    "comment": {"value": 0.9, "description": 0.6, "note": 0.5},
    "part": {"reference": 0.85, "value": 0.6, "description": 0.5},
}
_LONG = [(field, _folded(name)) for field, names in FIELDS.items() for name in names if len(name) >= 5]


def _meanings(words: str) -> Iterator[tuple[str, float]]:
    if words in _SHARED:
        yield from _SHARED[words].items()
        return
    exact = [(field, sure) for field in FIELDS if (sure := _EXACT.get((field, words)))]
    if exact:
        yield from exact
        return
    plain = re.sub(r"\s*[\[(].*?[\])]\s*", " ", words).strip()  # Quantity [pcs]
    if plain != words and plain:
        yield from ((field, 0.95 * sure) for field in FIELDS if (sure := _EXACT.get((field, plain))))
    for field, name in _LONG:
        if re.search(rf"(?<!\w){re.escape(name)}(?!\w)", words):
            yield field, 0.6 - 0.1 * (len(words) > 2 * len(name))


def _by_cells(header: tuple[str, ...], below: list[Row]) -> Iterator[Column]:
    """Columns whose header says nothing, but whose cells are references."""
    for place, cell in enumerate(header):
        texts = [row.cells[place] for row in below if place < len(row.cells) and row.cells[place]]
        if cell and len(texts) >= 3 and sum(map(are_references, texts)) > 0.8 * len(texts) and not are_references(cell):
            yield Column("reference", cell, place, 0.5)


def _checked(claim: Column, below: list[Row]) -> Column:
    """The claim, less sure where the cells contradict the header."""
    texts = [row.cells[claim.place] for row in below if claim.place < len(row.cells) and row.cells[claim.place]]
    fits = {"reference": are_references, "quantity": lambda text: bool(re.search(r"\d", text)) and len(text) < 20}
    if claim.field not in fits or not texts:
        return claim
    share = sum(map(fits[claim.field], texts)) / len(texts)
    trust = 0.0 if _folded(claim.header) in _OFTEN_OTHER else 0.3
    return Column(claim.field, claim.header, claim.place, claim.confidence * (trust + (1 - trust) * share))


_OFTEN_OTHER = {"pos", "position", "part", "parts", "ref", "count", "amount"}
"""Headers that are believed as far as the cells below agree: a position is often a running number."""


_WITH_NUMBERS = ("value", "description", "voltage", "tolerance", "power", "quantity")
_BARE = re.compile(r"-?[0-9.]+(?:[eE]-?[0-9]+)?")
_COMMA = re.compile(r"(?<![\w,.])(?:0|[1-9]\d{0,2}),(?:\d{1,2}|\d{4,})(?![\d,])")
_POINT = re.compile(r"(?<![\d,.])\d+\.(?:\d{1,2}|\d{4,})(?![\d.])")  # 1.000 may be a thousand


def _decimal(rows: tuple[Row, ...], places: list[int], semicolons: bool, written: bool) -> Decimal:
    """The decimal sign of this list; where no cell tells, the one that usually goes with its delimiter.

    Bare numbers tell it only where people, or a program in their language, have ``written`` them.
    """
    commas = points = 0
    for row in rows[:2000]:
        for place in places:
            cell = row.cells[place] if place < len(row.cells) else ""
            if written or not _BARE.fullmatch(cell):
                commas += bool(_COMMA.search(cell))
                points += bool(_POINT.search(cell))
    return "," if commas > points or (commas == points and semicolons) else "."


def parse_mapping(path: Path) -> ColumnMapping:
    """Read a mapping file. Raises DesignError with file and line."""
    from robophm.core.yaml_values import located
    from robophm.design.file import mapping, read

    data, lines = mapping(read(path), str(path), "mapping")

    def fail(place: tuple[str, ...], text: str) -> DesignError:
        return DesignError(located(str(path), lines, place, text))

    for key in data.keys() - {"schema_version", "columns", "decimal", "sheet"}:
        raise fail((key,), f"unknown key '{key}'{nearest(key, ('columns', 'decimal', 'sheet'))}")
    columns = data.get("columns")
    if not isinstance(columns, dict):
        raise fail(("columns",), "expected what each column means, e.g. {reference: Designator, value: Comment}")
    for field, header in columns.items():
        if field not in FIELDS:
            raise fail(("columns", field), f"unknown field '{field}'{nearest(field, FIELDS)}")
        if not isinstance(header, str | int | float) or isinstance(header, bool):
            raise fail(("columns", field), "expected the header of a column")
    decimal: Any = data.get("decimal")
    if decimal not in (None, ",", "."):
        raise fail(("decimal",), f"{decimal!r:.20}; expected ',' or '.'")
    sheet = data.get("sheet")
    if sheet is not None and not isinstance(sheet, str):
        raise fail(("sheet",), f"{sheet!r:.40}; expected the name of a sheet")
    return ColumnMapping({field: str(header) for field, header in columns.items()}, decimal, sheet)


def mapping_text(table: PartsTable) -> str:
    """A mapping file that reads this list as it was read."""
    from robophm.design.naming import quoted

    lines = [
        "# What the columns of a parts list mean; `robophm import-bom --mapping` reads it.",
        "schema_version: 1",
    ]
    lines += [f"sheet: {quoted(table.sheet)}"] if table.others else []
    lines += [f"decimal: {quoted(table.decimal)}", "columns:"]
    lines += [f"  {column.field}: {quoted(column.header)}" for column in table.columns]
    return "\n".join(lines) + "\n"
