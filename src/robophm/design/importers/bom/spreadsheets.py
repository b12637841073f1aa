"""Workbooks, .xlsx and .ods, as rows of texts: what cells show, never their formulas.

Read with the standard library: the little of both formats that a table needs is less than a dependency. Parts of the
archive are unpacked within a bound, and XML that declares a document type or entities is refused.
"""

from __future__ import annotations

import io
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any
from xml.parsers import expat

from robophm.design.importers.bom.sheets import MAX_COLUMNS, MAX_ROWS, SheetError

MAX_UNPACKED = 100_000_000
"""Bytes of one part of the archive."""

MAX_CHARACTERS = 50_000_000
"""The most characters of a sheet whose repeated cells are written out, or that shares texts."""

_BROKEN = (zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, RuntimeError, ValueError, OverflowError)
"""Errors that reading a broken archive can raise."""

Rows = Callable[[], Iterator[tuple[int, list[str]]]]
_OFFICE = "urn:oasis:names:tc:opendocument:xmlns:office:1.0 "
_TABLE = "urn:oasis:names:tc:opendocument:xmlns:table:1.0 "
_TEXT = "urn:oasis:names:tc:opendocument:xmlns:text:1.0 "


def workbook(content: bytes) -> list[tuple[str, Rows]]:
    """The sheets of a workbook by name. Raises SheetError, as reading them does."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except _BROKEN as error:
        raise SheetError(f"is no workbook: {error}") from None
    names = set(archive.namelist())
    if "content.xml" in names:
        sheets = _OpenDocument(archive).sheets()
        return [(name, partial(iter, rows)) for name, rows in sheets]
    if "xl/workbook.xml" in names:
        shared = _SharedTexts(archive).texts if "xl/sharedStrings.xml" in names else []
        found = sorted(
            (int(match[1]), name)
            for name in names
            if (match := re.fullmatch(r"xl/worksheets/sheet(\d{1,6})\.xml", name))
        )
        return [(f"sheet {number}", partial(_office_rows, archive, name, shared)) for number, name in found]
    raise SheetError("is an archive, but no workbook; expected .xlsx, .ods or .csv")


def _office_rows(archive: zipfile.ZipFile, name: str, shared: list[str]) -> Iterator[tuple[int, list[str]]]:
    return iter(_OfficeSheet(archive, name, shared).rows)


class _Reader:
    """Reads one XML part of an archive; subclasses override ``start`` and ``end``."""

    def __init__(self, archive: zipfile.ZipFile, name: str) -> None:
        self.text: list[str] = []
        self.characters = 0
        parser = expat.ParserCreate(namespace_separator=" ")
        parser.buffer_text = True
        parser.StartElementHandler = self.start
        parser.EndElementHandler = self.end
        parser.CharacterDataHandler = self.text.append
        parser.StartDoctypeDeclHandler = _no_document_type
        try:
            with archive.open(name) as stream:
                left = MAX_UNPACKED
                while piece := stream.read(min(left + 1, 1 << 16)):
                    left -= len(piece)
                    if left < 0:
                        raise SheetError(f"{name} unpacks to more than {MAX_UNPACKED / 1e6:.0f} MB")
                    parser.Parse(piece, False)
                parser.Parse(b"", True)
        except expat.ExpatError as error:
            raise SheetError(f"{name} is not XML: {error}") from None
        except SheetError:
            raise
        except _BROKEN as error:
            raise SheetError(f"{name} cannot be unpacked: {error}") from None

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Called where an element begins."""

    def end(self, tag: str) -> None:
        """Called where an element ends."""

    def taken(self) -> str:
        """The text since it was last asked for."""
        text = "".join(self.text)
        self.text.clear()
        self.count(len(text))
        return text

    def count(self, characters: int) -> None:
        self.characters += characters
        if self.characters > MAX_CHARACTERS:
            raise SheetError(f"unfolds to more than {MAX_CHARACTERS:,} characters")


def _no_document_type(*_: Any) -> None:
    raise SheetError("declares a document type; expected a workbook as spreadsheets write it")


def _local(tag: str) -> str:
    return tag.rpartition(" ")[2]


class _SharedTexts(_Reader):
    """The texts of an .xlsx, which its cells name by number."""

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self.texts: list[str] = []
        self.whole: list[str] = []
        super().__init__(archive, "xl/sharedStrings.xml")

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        if _local(tag) == "si":
            self.whole = []
        self.text.clear()

    def end(self, tag: str) -> None:
        if _local(tag) == "t":
            self.whole.append(self.taken())
        elif _local(tag) == "rPh":  # how it is spoken
            self.whole = self.whole[:1]
        elif _local(tag) == "si":
            self.texts.append("".join(self.whole))


class _OfficeSheet(_Reader):
    """A sheet of an .xlsx."""

    def __init__(self, archive: zipfile.ZipFile, name: str, shared: list[str]) -> None:
        self.shared = shared
        self.rows: list[tuple[int, list[str]]] = []
        self.kind = ""
        self.column = 0
        self.number = 0
        self.whole: list[str] = []
        super().__init__(archive, name)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        tag = _local(tag)
        if tag == "row":
            self.number = _count(attributes.get("r"), self.number + 1, 1 << 20)
            self.column = -1
            self.rows.append((self.number, []))
            if len(self.rows) > 2 * MAX_ROWS:  # most of them may be blank
                raise SheetError(f"has more than {2 * MAX_ROWS:,} rows")
        elif tag == "c":
            self.kind, self.whole = attributes.get("t", "n"), []
            self.column = _column(attributes.get("r", ""), self.column + 1)
        self.text.clear()

    def end(self, tag: str) -> None:
        tag = _local(tag)
        if tag in ("v", "t"):
            self.whole.append(self.taken())
        elif tag == "c" and self.rows:
            said = self.shown("".join(self.whole))
            self.count(len(said))
            cells = self.rows[-1][1]
            if said and self.column < MAX_COLUMNS:
                cells.extend([""] * (self.column + 1 - len(cells)))
                cells[self.column] = said
            elif said:
                raise SheetError(f"row {self.number} has more than {MAX_COLUMNS:,} columns")

    def shown(self, said: str) -> str:
        if self.kind == "s":
            number = _count(said, 0, 1 << 31)
            if number >= len(self.shared):
                raise SheetError(f"row {self.number} names text {number}, and there are {len(self.shared)}")
            return self.shared[number]
        return _number(said) if self.kind == "n" else "" if self.kind == "e" else said


class _OpenDocument(_Reader):
    """The sheets of an .ods."""

    def __init__(self, archive: zipfile.ZipFile) -> None:
        self.found: list[tuple[str, list[tuple[int, list[str]]]]] = []
        self.cells: list[str] = []
        self.blank = 0
        self.number = 1
        self.repeated_rows = self.repeated = 1
        self.value: str | None = None
        self.whole: list[str] = []
        self.notes = 0
        super().__init__(archive, "content.xml")

    def sheets(self) -> list[tuple[str, list[tuple[int, list[str]]]]]:
        return self.found

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        if tag == _OFFICE + "annotation":
            self.notes += 1
        elif tag == _TABLE + "table":
            self.found.append((attributes.get(_TABLE + "name", f"sheet {len(self.found) + 1}"), []))
            self.number = 1
        elif tag == _TABLE + "table-row":
            self.cells, self.blank = [], 0
            self.repeated_rows = _count(attributes.get(_TABLE + "number-rows-repeated"), 1, 1 << 31)
        elif tag in (_TABLE + "table-cell", _TABLE + "covered-table-cell"):
            self.repeated = _count(attributes.get(_TABLE + "number-columns-repeated"), 1, 1 << 31)
            numeric = attributes.get(_OFFICE + "value-type") in ("float", "currency")
            self.value = attributes.get(_OFFICE + "value") if numeric else None
            self.whole = []
        elif tag == _TEXT + "s":
            self.text.append(" ")
        elif tag == _TEXT + "p":
            self.text.clear()

    def end(self, tag: str) -> None:
        if tag == _OFFICE + "annotation":
            self.notes -= 1
        elif tag == _TEXT + "p" and not self.notes:
            self.whole.append(self.taken())
        elif tag in (_TABLE + "table-cell", _TABLE + "covered-table-cell"):
            said = " ".join(self.whole) if self.value is None else _number(self.value)
            if not said:
                self.blank += self.repeated  # written out only where something follows
                return
            if len(self.cells) + self.blank + self.repeated > MAX_COLUMNS:
                raise SheetError(f"row {self.number} has more than {MAX_COLUMNS:,} columns")
            self.count(len(said) * self.repeated)
            self.cells += [""] * self.blank + [said] * self.repeated
            self.blank = 0
        elif tag == _TABLE + "table-row":
            if self.cells and self.found:
                rows = self.found[-1][1]
                if len(rows) + self.repeated_rows > MAX_ROWS:
                    raise SheetError(f"has more than {MAX_ROWS:,} rows")
                self.count(sum(map(len, self.cells)) * (self.repeated_rows - 1))
                rows += [(self.number + i, self.cells) for i in range(self.repeated_rows)]
            self.number += self.repeated_rows


def _number(said: str) -> str:
    """The number as a text would state it: 3 for 3.0; 1.125 with a zero more, which nobody takes for a thousand."""
    said = said.removesuffix(".0")
    return said + "0" if re.fullmatch(r"-?\d+\.\d{3}", said) else said


def _count(said: str | None, otherwise: int, most: int) -> int:
    if said is None:
        return otherwise
    if not re.fullmatch(r"\d{1,10}", said) or int(said) > most:
        raise SheetError(f"'{said:.20}' is not a number of rows or columns")
    return int(said)


def _column(place: str, otherwise: int) -> int:
    """The column of a cell's place: 0 for 'A7', 27 for 'AB7'."""
    letters = re.match(r"[A-Z]{1,3}", place)
    if not letters:
        return otherwise
    number = 0
    for letter in letters[0]:
        number = number * 26 + ord(letter) - 64
    return number - 1
