"""Questions and tables of the commands that draft or bind a design (``robophm new``, ``bind``), on the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.output import console, print_table, table, warn
from robophm.core.errors import RobophmError
from robophm.drafting.answers import Question, check
from robophm.drafting.bindings import Proposal
from robophm.drafting.first_look import FirstLook, PartFigures
from robophm.report.first_look import advice, figure_rows, part_rows
from robophm.report.words import duration_text

Bag = Annotated[
    list[Path] | None, typer.Option("--bag", help="a recording, or a folder of recordings; may be repeated")
]


def ask(question: Question) -> str:
    """Put a question on the terminal until it is answered with what can be; "" takes what is assumed."""
    while True:
        taken = f" [{question.default}: {question.because}]" if question.default else f" [{question.because}]"
        said: str = typer.prompt(question.text + taken, default="", show_default=False).strip()
        try:
            if said:
                check(question.key, said)
            return said
        except RobophmError as error:
            warn(str(error))


def print_parts_of(figures: Sequence[PartFigures]) -> None:
    """A draft's parts: rate, source and grade, stress, signal."""
    columns = ("part", "library or list", "λ, 5 … 95 % [FPMH]", "grade", "answers to", "listens to")
    print_table(console(), table("", columns, part_rows(list(figures)), figures=(2,)))


def print_bindings(bound: Sequence[Proposal], unbound: Sequence[str]) -> None:
    """Bindings by example, with the values seen, and why others have none."""
    if bound:
        rows = [(one.part or "the robot", one.input, "\n".join(one.signals), one.seen) for one in bound]
        print_table(console(), table("Bound", ("part", "input", "signal", "seen"), rows))
    for one in bound:
        if one.assumed:
            warn(f"{one.part}: {one.input}: {one.assumed}", "assumed")
    for note in unbound:
        warn(note, "not bound")


def print_look(look: FirstLook) -> None:
    """The first figures of a robot as ranges, and what to ask next."""
    out = console()
    lived = f"after {duration_text(look.lived)} of recorded operation" if look.report else "as designed, new"
    rows = figure_rows(look)
    print_table(out, table(f"{look.robot.name}, {lived}", ("", "5 %", "50 %", "95 %"), rows, figures=(1, 2, 3)))
    said = list(advice(look))
    if said:
        out.print("What it would help most to know:", style="bold")
    for one in said:
        out.print(f"  {one}", markup=False, soft_wrap=True)
