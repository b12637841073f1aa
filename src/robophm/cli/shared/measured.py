"""Options of the commands that look at measured data, and what they share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from robophm.cli.shared.output import print_table, table, warn
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.core.units import quantity
from robophm.report.bars import bar_text
from robophm.report.words import number_text

Bags = Annotated[list[Path], typer.Argument(help="recordings, rosbag2 folders, or folders of recordings")]
SignalName = Annotated[
    str, typer.Option("--signal", help="a signal: /topic.field, /topic.field[2], /topic.field[name]")
]
SignalNames = Annotated[
    list[str], typer.Option("--signal", help="a signal: /topic.field, with [2] or [name] of an array; may be repeated")
]
Gap = Annotated[str, typer.Option("--gap", help="how long a value holds at most; after that nothing is known")]
Together = Annotated[bool, typer.Option("--together", help="take the recordings as one drive")]
Apart = Annotated[bool, typer.Option("--apart", help="take each file by itself, even where one follows another")]
Overwrite = Annotated[bool, typer.Option("--force", help="overwrite a file that exists")]
Bins = Annotated[int, typer.Option("--bins", help="largest number of levels", min=2, max=1000)]
Most = Annotated[int, typer.Option("--most", help="largest number to list", min=1, max=100_000)]
Page = Annotated[Path | None, typer.Option("--report", help="write an HTML page about it")]


def nanoseconds(text: str) -> int:
    """Return a written time in nanoseconds. Raises UnitError."""
    seconds = quantity(text, "s")
    if not abs(seconds) < 2**62 / SECOND:
        raise RobophmError(f"'{text}' is too long; expected at most a century")
    return round(seconds * SECOND)


def max_age(gap: str) -> int:
    """Return how long a value holds [ns]. Raises RobophmError where that is no time."""
    time = nanoseconds(gap)
    if time <= 0:
        raise RobophmError(f"--gap {gap}: expected a time above zero")
    return time


def print_levels(out: Console, title: str, rows: Mapping[str, float]) -> None:
    """Print shares of levels as bars."""
    top = max(rows.values(), default=0.0) or 1.0
    lines = [(name, f"{number_text(100 * share, 3)} %", bar_text(share / top)) for name, share in rows.items()]
    out.print(f"\n{title}", style="bold", markup=False)
    print_table(out, table("", ("level", "share", ""), lines, figures=(0, 1)))


def warn_of(notes: Sequence[str]) -> None:
    """Print each note as a warning on stderr."""
    for note in notes:
        warn(note)
