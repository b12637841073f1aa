"""Output of commands: tables for people, JSON for machines on stdout alone, progress on a terminal's stderr alone."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from rich.cells import cell_len
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from robophm.cli.shared.option_hints import with_options
from robophm.core.errors import RobophmError
from robophm.core.files import STANDARD_INPUT
from robophm.core.json_values import plain

SCHEMA_VERSION = 1
"""Version of what ``--json`` prints; each document says it."""


PLAIN_WIDTH = 120
"""Columns of what is printed into a file or a pipe."""

NARROWEST = 40
"""Columns below which a terminal is not believed."""


def console() -> Console:
    """Return the console for people, on stdout; plain where it is no terminal or NO_COLOR is set."""
    colours: Literal["auto"] | None = None if os.environ.get("NO_COLOR") else "auto"  # bold is an escape code too
    out = Console(highlight=False, width=None if sys.stdout.isatty() else PLAIN_WIDTH, color_system=colours)
    out.width = max(out.width, NARROWEST)
    return out


def progress_console() -> Console:
    """Return the console for progress, on stderr."""
    return Console(stderr=True, highlight=False)


def print_json(document: Mapping[str, Any], *, one_of_many: bool = False) -> None:
    """Print one JSON document on stdout, with its schema version first; one of many takes one line."""
    text = json_text({"schema_version": SCHEMA_VERSION, **document}, indent=None if one_of_many else 2)
    sys.stdout.write(text + "\n")


def json_text(document: Mapping[str, Any], *, indent: int | None = 2) -> str:
    """Return a document as it is printed: stdout that cannot show a character gets its JSON escape.

    JSON has no number for what is infinite: it is the text "Infinity" or "-Infinity"; null is what does not apply.
    """
    unicode = sys.stdout.encoding.lower().startswith("utf")
    return json.dumps(plain(document), indent=indent, ensure_ascii=not unicode, allow_nan=False)


def warn(text: str, kind: str = "warning") -> None:
    """Print one line on stderr that does not stop anything."""
    print(f"{kind}: {with_options(text)}", file=sys.stderr)


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]], *, figures: Iterable[int] = ()) -> Table:
    """Return a table of texts; the columns counted in ``figures`` stand right. User text is never markup."""
    figures = frozenset(figures)
    result = Table(
        title=Text(title) if title else None,
        title_justify="left",
        title_style="bold",
        header_style="bold",
        box=None,
        pad_edge=False,
    )
    rows = list(rows)
    for i, column in enumerate(columns):
        if i in figures:
            widest = max(map(cell_len, (column, *(row[i] for row in rows))))
            result.add_column(Text(column), justify="right", no_wrap=True, min_width=widest)
        else:
            result.add_column(Text(column), overflow="fold")
    for row in rows:
        result.add_row(*(Text(cell) for cell in row))
    return result


def print_table(out: Console, table: Table) -> None:
    """Print a table whose figures are never cut: texts wrap, and what is still wider than the terminal runs over."""
    needed = Measurement.get(out, out.options.update_width(1000), table).minimum
    if needed > out.width:
        table.width = needed
    out.print(table, crop=False)


def may_write(path: Path | None, *inputs: Path) -> None:
    """Raise RobophmError, before any work, where a file cannot be written or would take the place of an input."""
    if path is None:
        return
    if path == STANDARD_INPUT:
        raise RobophmError("-: is standard input, which is read; expected the name of a file to write")
    if any(path.resolve() == other.resolve() for other in inputs):
        raise RobophmError(f"{path}: is read or kept by this command too; expected a file of its own")
    if not path.parent.is_dir():
        raise RobophmError(f"{path}: cannot be written: no such folder")
    if path.is_dir():
        raise RobophmError(f"{path}: cannot be written: is a folder")


def may_make(path: Path | None, *inputs: Path, force: bool, suffixes: Sequence[str] = ()) -> None:
    """Check likewise a file that is only replaced where the user says so; its name ends as it will be read."""
    may_write(path, *inputs)
    if path is None:
        return
    if suffixes and path.suffix not in suffixes:
        raise RobophmError(f"{path}: cannot be written; expected a name that ends in {' or '.join(suffixes)}")
    if path.exists() and not force:
        raise RobophmError(f"{path}: exists; expected a new name, or --force to replace it")


def write(path: Path, text: str | bytes) -> None:
    """Write a file whole or not at all. Raises RobophmError."""
    from robophm.core.files import write_atomically

    try:
        write_atomically(path, text)
    except OSError as error:
        raise RobophmError(f"{path}: cannot be written: {error.strerror}") from None
