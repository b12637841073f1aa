"""A file as rows of texts: comma, semicolon or tab separated text in any usual encoding, xlsx, ods.

What is read is bounded before it is read, and a formula stays a text: nothing in a list is ever computed.
"""

from __future__ import annotations

import codecs
import csv
import io
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

from robophm.core.errors import DesignError, nearest_file
from robophm.core.files import STANDARD_INPUT, stream_of
from robophm.design.importers.bom.sheets import MAX_COLUMNS, MAX_ROWS, SheetError
from robophm.design.importers.bom.spreadsheets import workbook

MAX_BYTES = 20_000_000
"""A larger file is refused before it is parsed."""


LONGEST_CELL = 100_000
"""Characters; a list of references may be long."""

DELIMITERS = {",": "comma", ";": "semicolon", "\t": "tab"}


class Row(NamedTuple):
    """A row that is not blank, by its number in the file, from 1."""

    number: int
    cells: tuple[str, ...]


@dataclass(frozen=True)
class Sheet:
    """One of the ways to read a file: a sheet of a workbook, or text with one delimiter."""

    name: str
    rows: Callable[[], Iterator[Row]]


def read_sheets(path: Path) -> list[Sheet]:
    """The ways in which a file can be read. Raises DesignError for what is no table, too large or broken.

    The rows of a sheet are read when they are asked for, and raise SheetError.
    """
    content = _content(path)
    try:
        if content.startswith(b"PK\x03\x04"):
            return [Sheet(name, partial(_bounded, rows)) for name, rows in workbook(content)]
        text = _decoded(content)
    except SheetError as error:
        raise DesignError(f"{path}: {error}") from None
    first, _, rest = text.partition("\n")
    if first.strip().lower().startswith("sep=") and first.strip()[4:] in DELIMITERS:  # what spreadsheets write
        return [
            Sheet(DELIMITERS[first.strip()[4:]], partial(_bounded, partial(_separated, rest, first.strip()[4:], 2)))
        ]
    return [Sheet(name, partial(_bounded, partial(_separated, text, mark, 1))) for mark, name in DELIMITERS.items()]


def _content(path: Path) -> bytes:
    try:
        if path != STANDARD_INPUT and not path.exists():
            beside = [other.name for other in path.parent.iterdir()] if path.parent.is_dir() else []
            raise DesignError(f"{path}: no such file{nearest_file(path.name, beside)}")
        with stream_of(path) as stream:
            content = stream.read(MAX_BYTES + 1)  # a device never ends, whatever size it says
    except OSError as error:
        raise DesignError(f"{path}: cannot be read: {error.strerror}") from None
    if len(content) > MAX_BYTES:
        raise DesignError(f"{path}: is more than {MAX_BYTES / 1e6:.0f} MB; a parts list is at most that")
    return content


def _decoded(content: bytes) -> str:
    """UTF-16 with its mark, UTF-8, or what is left: Windows' cp1252."""
    if content.startswith(b"\xd0\xcf\x11\xe0"):
        raise SheetError("is an old Excel workbook; expected .xlsx, .ods or .csv: save it as one of them")
    encodings = (
        ("utf-16",) if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else ("utf-8-sig", "cp1252")
    )
    for encoding in encodings:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise SheetError("is not text; expected a parts list as .csv, .xlsx or .ods")


def _separated(text: str, delimiter: str, first: int) -> Iterator[tuple[int, Iterable[str]]]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    before = 0
    try:
        for cells in reader:
            yield before + first, cells  # where the row begins: a cell may hold line breaks
            before = reader.line_num
    except csv.Error as error:
        raise SheetError(f"line {before + first}: {error}") from None


def _bounded(rows: Callable[[], Iterable[tuple[int, Iterable[str]]]]) -> Iterator[Row]:
    """The rows that are not blank, trimmed. Raises SheetError where there are too many, or one is too long."""
    count = 0
    for number, found in rows():
        cells = [" ".join(cell.split()) for cell in found]
        while cells and not cells[-1]:
            cells.pop()
        if not cells:
            continue
        count += 1
        if count > MAX_ROWS:
            raise SheetError(f"has more than {MAX_ROWS:,} rows")
        if len(cells) > MAX_COLUMNS:
            raise SheetError(f"row {number} has {len(cells):,} columns; expected at most {MAX_COLUMNS:,}")
        if (longest := max(map(len, cells))) > LONGEST_CELL:
            raise SheetError(f"row {number} has a cell of {longest:,} characters; expected at most {LONGEST_CELL:,}")
        yield Row(number, tuple(cells))
