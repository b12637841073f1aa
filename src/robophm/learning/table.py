"""Tables that people keep: CSV with a heading, or a list in YAML; every cell with the line that it stands in."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from robophm.core.errors import DataError, DesignError, UnitError, nearest
from robophm.core.units import quantity
from robophm.design.file import mapping, read

MOST_ROWS = 1_000_000
LONGEST_CELL = 2000

_HEADING = re.compile(r"(?P<name>[^\[\]()]+?)\s*(?:[\[(](?P<unit>[^\[\]()]*)[\])])?\s*\Z")


@dataclass(frozen=True)
class Row:
    """One line of a table, by column."""

    table: str
    line: int
    cells: Mapping[str, str]
    """Texts of the cells by column; an empty cell is not there."""
    units: Mapping[str, str]
    """Units that the headings of columns state."""
    headings: Mapping[str, str] = field(default_factory=dict)
    """Columns as the table heads them, without units."""

    def text(self, column: str, default: str = "") -> str:
        """Return the text in a column."""
        return self.cells.get(column, default)

    def error(self, message: str, column: str = "") -> DataError:
        """Return an error at this line, to be raised."""
        return DataError(f"{self.table}:{self.line}: {f'{column}: ' if column else ''}{message}")

    def number(self, column: str, default: float | None = None) -> float:
        """Return a plain number. Raises DataError where it is none, not finite, or missing without a default."""
        written = self.text(column)
        if not written:
            if default is None:
                raise self.error("is empty; expected a number", column)
            return default
        try:
            value = float(written)
        except ValueError:
            raise self.error(f"{written!r:.60} is no number; expected one without a unit", column) from None
        if not math.isfinite(value):
            raise self.error(f"{written!r:.60} is not a finite number", column)
        return value

    def quantity(self, column: str, unit: str, text: str | None = None) -> float:
        """Return a quantity in a unit, which the cell or its column's heading states. Raises DataError."""
        written = self.text(column) if text is None else text
        stated = self.units.get(column, "")
        bare = re.fullmatch(r"[-+.\deE]+", written) is not None
        try:
            return quantity(f"{written} {stated}" if bare and stated else written, unit)
        except UnitError as error:
            hint = f"; or head the column '{column} [{unit}]'" if bare and not stated else ""
            raise self.error(f"{error}{hint}", column) from None

    def choice(self, column: str, options: Mapping[str, Sequence[str]], default: str) -> str:
        """Return one of some options, in any of its spellings. Raises DataError."""
        written = self.text(column).strip().casefold()
        if not written:
            return default
        for option, spellings in options.items():
            if written == option or written in spellings:
                return option
        raise self.error(f"{written!r:.60}; expected {' or '.join(options)}", column)


def date_of(row: Row, column: str) -> datetime:
    """Return a date in ISO 8601; without a time zone it is UTC, wherever it is read. Raises DataError."""
    written = row.text(column)
    if not written:
        raise row.error("is empty; expected a date, e.g. 2024-03-18", column)
    try:
        date = datetime.fromisoformat(written)
    except ValueError:
        raise row.error(f"{written!r:.40} is no date; expected e.g. 2024-03-18 or 2024-03-18T14:30", column) from None
    return date if date.tzinfo else date.replace(tzinfo=UTC)


YES = {"yes": ("y", "true", "1", "x"), "no": ("n", "false", "0")}
"""Spellings of yes and no."""


def read_table(path: Path, columns: Mapping[str, Sequence[str]], what: str, *, free: bool = False) -> list[Row]:
    """Read the rows of a CSV file, or of a YAML file's list ``what``; at least one.

    ``columns``: their names and other spellings. Another column is refused unless tables are ``free`` to have more;
    one whose heading begins with # or is 'note' is left out. Raises DataError.
    """
    try:
        text = read(path)
    except DesignError as error:
        raise DataError(str(error)) from None
    rows = _of_yaml(path, text, what) if path.suffix.lower() in (".yaml", ".yml") else _of_csv(path, text)
    if not rows:
        raise DataError(f"{path}: holds no {what}; expected columns {', '.join(columns)}")
    names: dict[str, str | None] = {}
    units: dict[str, str] = {}
    headings: dict[str, str] = {}
    found = []
    for line, cells in rows:
        for heading in [one for one in cells if one not in names]:
            name = _column(path, line, heading, columns, free)
            names[heading] = name
            match = _HEADING.match(heading)
            if name is not None:
                headings.setdefault(name, match["name"] if match else heading)
            if name is not None and match and match["unit"]:
                units[name] = match["unit"].strip()
        kept: dict[str, str] = {}
        for heading, cell in cells.items():
            name = names[heading]
            if name is None or not cell.strip():
                continue
            if name in kept:
                both = " and ".join(f"'{one:.60}'" for one in cells if names[one] == name)
                raise DataError(f"{path}:{line}: two columns are '{name}'; expected one of {both}")
            if len(cell) > LONGEST_CELL:
                raise DataError(f"{path}:{line}: {name}: a cell of {len(cell):,} characters")
            kept[name] = cell.strip()
        found.append((line, kept))
    return [Row(str(path), line, kept, units, headings) for line, kept in found]


def _column(path: Path, line: int, heading: str, columns: Mapping[str, Sequence[str]], free: bool) -> str | None:
    """The column that a heading means; None where it is a remark."""
    match = _HEADING.match(heading.strip())
    plain = (match["name"] if match else heading).strip()
    folded = plain.casefold()
    if heading.strip().startswith("#") or folded in ("", "note", "notes", "remark", "comment"):
        return None
    for name, spellings in columns.items():
        if folded == name.casefold() or folded in spellings:
            return name
    if free:
        return plain
    raise DataError(f"{path}:{1 if path.suffix.lower() == '.csv' else line}: unknown column '{heading:.60}'"
                    f"{nearest(folded, columns)}")  # fmt: skip


def _of_csv(path: Path, text: str) -> list[tuple[int, dict[str, str]]]:
    first = text.lstrip("\n\r").partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    reader = csv.reader(io.StringIO(text), delimiter=delimiter)
    try:
        heading: list[str] | None = None
        rows = []
        for cells in reader:
            if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
                continue
            if heading is None:
                heading = [cell.strip() for cell in cells]
                if twice := next((one for one in heading if one and heading.count(one) > 1), None):
                    raise DataError(f"{path}:{reader.line_num}: two columns are headed '{twice:.60}'; expected one")
                continue
            if len(cells) > len(heading):
                raise DataError(f"{path}:{reader.line_num}: has {len(cells)} cells; expected {len(heading)}, as headed")
            rows.append((reader.line_num, dict(zip(heading, cells, strict=False))))
            if len(rows) > MOST_ROWS:
                raise DataError(f"{path}: has more than {MOST_ROWS:,} rows")
    except csv.Error as error:
        raise DataError(f"{path}:{reader.line_num}: is no CSV: {error}") from None
    return rows


def _of_yaml(path: Path, text: str, what: str) -> list[tuple[int, dict[str, str]]]:
    try:
        data, lines = mapping(text, str(path), f"list of {what}")
    except DesignError as error:
        raise DataError(str(error)) from None
    for key in data.keys() - {"schema_version", what}:
        line = lines.get((key,), 1)
        raise DataError(f"{path}:{line}: unknown key '{key}'{nearest(key, [what, 'schema_version'])}")
    listed = data.get(what)
    if not isinstance(listed, list) or not all(isinstance(one, dict) for one in listed):
        raise DataError(f"{path}:{lines.get((what,), 1)}: {what}: expected a list with a mapping for each")
    if len(listed) > MOST_ROWS:
        raise DataError(f"{path}: has more than {MOST_ROWS:,} rows")
    return [
        (lines[what, str(i)], {key: "" if value is None else _plain(value) for key, value in one.items()})
        for i, one in enumerate(listed)
    ]


def _plain(value: object) -> str:
    return "; ".join(map(str, value)) if isinstance(value, list) else str(value)
