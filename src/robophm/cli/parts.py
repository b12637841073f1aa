"""``robophm parts``: the library of robot parts, searched and in full, and the reference page made of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Annotated, Any

import typer
from rich.console import Console

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.unused import refuse_unused
from robophm.cli.shared.where_else import in_handbooks
from robophm.core.errors import PlugError
from robophm.design.naming import quoted
from robophm.parts import GRADES, Entry, library, search
from robophm.report.part_reference import figures
from robophm.report.part_reference import reference as page


def command(
    words: Annotated[
        list[str] | None, typer.Argument(help="words for a part, e.g. gps receiver; or the name of an entry")
    ] = None,
    reference: Annotated[bool, typer.Option("--reference", help="print the reference page as Markdown")] = False,
    as_json: Json = False,
) -> None:
    """Search the library of robot parts: failure modes, rates and their sources."""
    if reference:
        refuse_unused("the reference page", ("reference",), as_json=False)
        typer.echo("\n".join(page()))
    else:
        run(" ".join(words or ()), as_json=as_json)


def run(words: str, *, as_json: bool) -> None:
    """List the entries that fit, or print the one of that name. Raises PlugError where nothing fits."""
    found = [library()[words]] if words in library() else search(words) if words else list(library().values())
    if not found:
        elsewhere = in_handbooks(words) or "; expected other words: robophm parts lists all"
        raise PlugError(f"no part '{words:.60}' in the library{elsewhere}")
    if as_json:
        print_json({"parts": [asdict(entry) for entry in found]})
    elif words in library():
        _print_entry(console(), found[0])
    else:
        rows = [(entry.name, entry.title, figures(entry), entry.grade) for entry in found]
        out = console()
        print_table(out, table("", ("part", "what it is", "fails by", "grade"), rows))
        out.print("One in full: robophm parts NAME. In a design: Name: {part: NAME}.", markup=False, soft_wrap=True)


def _print_entry(out: Console, entry: Entry) -> None:
    out.print(f"{entry.name}: {entry.title}", style="bold", markup=False, soft_wrap=True)
    told = [(f"grade {entry.grade}", GRADES[entry.grade]), ("statement", entry.statement), ("source", entry.source)]
    told += [("reasoning", entry.reasoning), ("found by", ", ".join(entry.words))]
    print_table(out, table("", ("", ""), [row for row in told if row[1]]))
    out.print(f"\nIn a design, Name: {{part: {entry.name}}} is", markup=False, soft_wrap=True)
    for line in _yaml(entry.part, "  "):
        out.print(line, markup=False, soft_wrap=True)


def _yaml(said: Mapping[str, Any], pad: str) -> Iterator[str]:
    """Keys and values as a design has them, failure modes line by line."""
    for key, value in said.items():
        if key == "failure_modes":
            yield f"{pad}{key}:"
            for name, mode in value.items():
                yield f"{pad}  {quoted(name)}:"
                yield from _yaml(mode, pad + "    ")
        else:
            yield f"{pad}{key}: {_inline(value)}"


def _inline(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_inline(one)}" for key, one in value.items()) + "}"
    if isinstance(value, Sequence) and not isinstance(value, str):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return quoted(value) if isinstance(value, str) else str(value)
