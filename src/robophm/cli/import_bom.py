"""``robophm import-bom``: a parts list becomes part of a design, and what was made of its rows is said."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, may_write, print_json, print_table, table, warn, write
from robophm.core.errors import RobophmError
from robophm.design.file import replace_text
from robophm.design.importers.bom import (
    ImportedList,
    ImportedPart,
    assumed_inputs,
    by_kind,
    import_bom,
    rate_range,
    total_rate,
)
from robophm.design.importers.bom.assumptions import OF_ALL, Assumptions
from robophm.design.importers.bom.columns import ColumnMapping, mapping_text, parse_mapping
from robophm.design.importers.bom.merging import State
from robophm.hazard.environments import explained
from robophm.hazard.qualities import UNKNOWN
from robophm.report.surroundings import rates_by_quality
from robophm.report.words import number_text, rate_text

COUNTED: tuple[State, ...] = ("added", "changed", "unchanged", "kept")
CHANGED: tuple[State, ...] = ("changed", "kept")
"""States of parts that are listed one by one."""

MOST_LINES = 20
"""The most lines of one kind, for people; --json has them all."""


@dataclass(frozen=True)
class Wishes:
    """The options of an import."""

    module: str | None = None
    mapping: Path | None = None
    save_mapping: Path | None = None
    environment: str | None = None
    temperature: str = Assumptions.temperature
    stress: float = Assumptions.stress
    quality: str | None = None
    dry_run: bool = False
    as_json: bool = False


def command(
    source: Annotated[Path, typer.Argument(help="parts list to import", metavar="PARTS.CSV|XLSX|ODS")],
    design: Annotated[
        Path, typer.Argument(help="design file to create, or to update from the list", metavar="ROBOT.YAML")
    ],
    module: Annotated[
        str | None, typer.Option(help="module that the parts belong to, e.g. 'Power/Motor board'; default: the robot")
    ] = None,
    mapping: Annotated[
        Path | None, typer.Option(help="file that says what the columns mean, written by --save-mapping")
    ] = None,
    save_mapping: Annotated[Path | None, typer.Option(help="write what each column was taken for")] = None,
    environment: Annotated[
        str | None,
        typer.Option(
            help="environment, e.g. vehicle, indoor, flying, or a symbol such as GM; default: the design's, or GM"
        ),
    ] = None,
    temperature: Annotated[str, typer.Option(help="temperature around the parts")] = "40 degC",
    stress: Annotated[float, typer.Option(help="stress ratio: applied by rated voltage or power", min=0, max=1)] = 0.5,
    quality: Annotated[
        str | None, typer.Option(help="quality: commercial, 'known pedigree', military, or a model's level")
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="only say what would be written")] = False,
    as_json: Json = False,
) -> None:
    """Import a parts list into a design, with rates where enough is known, and list the assumptions."""
    wishes = Wishes(module, mapping, save_mapping, environment, temperature, stress, quality, dry_run, as_json)
    run(source, design, wishes)


def run(source: Path, design: Path, wishes: Wishes) -> None:
    """Import the parts and write the design. Raises RobophmError, nothing written, where the list or the design is
    none.
    """
    inputs = [source, *([wishes.mapping] if wishes.mapping else [])]
    may_write(design, *inputs)
    may_write(wishes.save_mapping, source, design)
    mapping = parse_mapping(wishes.mapping) if wishes.mapping else ColumnMapping({})
    module = wishes.module.split("/") if wishes.module else []
    if not all(step.strip() for step in module):
        raise RobophmError(f"--module {wishes.module!r:.80}: expected names with / between them")
    assumptions = Assumptions(wishes.temperature, wishes.stress, quality=wishes.quality)
    found = import_bom(
        source, design, mapping=mapping, assumptions=assumptions, environment=wishes.environment, module=module
    )
    if wishes.save_mapping:
        write(wishes.save_mapping, mapping_text(found.parts_list.table))
    if not wishes.dry_run:
        if design.exists():
            replace_text(design, found.text)
        else:
            write(design, found.text)
    if wishes.as_json:
        print_json(_document(found, source, design, wishes))
    else:
        _print(found, source, design, wishes)


def _document(found: ImportedList, source: Path, design: Path, wishes: Wishes) -> dict[str, Any]:
    parts, read = found.parts_list, found.parts_list.table
    return {
        "robot": found.robot.name,
        "design": str(design),
        "list": str(source),
        "written": not wishes.dry_run,
        "sheet": read.sheet,
        "header_row": read.header_row,
        "decimal": read.decimal,
        "columns": [{"field": c.field, "header": c.header, "confidence": c.confidence} for c in read.columns],
        "unused_columns": list(read.unused),
        "assumptions": asdict(found.assumptions),
        "assumed": [
            {"kind": kind, "input": name, "rows": values.total(), "values": dict(values)}
            for kind, of in by_kind(found.parts).items()
            for name, values in assumed_inputs(of).items()
        ],
        "hazard_rate": total_rate(found.parts),
        "hazard_rate_by_quality": dict(zip(("low", "high"), rate_range(found.parts), strict=True)),
        "parts": [_part(one) for one in found.parts],
        "removed": [asdict(one) for one in found.removed],
        "errors": [asdict(one) for one in parts.errors],
        "left_out": [asdict(one) for one in parts.left_out],
        "notes": [asdict(one) for one in parts.notes],
    }


def _part(one: ImportedPart) -> dict[str, Any]:
    rating = one.rating
    return {
        "name": one.outcome.name,
        "state": one.outcome.state,
        "text": one.outcome.text,
        "row": one.part.row,
        "references": list(one.part.references),
        "quantity": one.part.quantity,
        "kind": one.part.recognised.kind,
        "kind_by": one.part.recognised.concluded.get("kind", "its words and letters"),
        "guess": one.guess,
        "facts": dict(one.part.recognised.facts),
        "model": (rating.model or None) if rating else None,
        "part": rating.entry.name if rating and rating.entry else None,
        "inputs": dict(rating.inputs) if rating else None,
        "assumed": dict(rating.assumed) if rating else {},
        "hazard_rate": one.hazard_rate,
    }


def _print(found: ImportedList, source: Path, design: Path, wishes: Wishes) -> None:
    parts, read, out = found.parts_list, found.parts_list.table, console()
    _warn(source, map(str, parts.errors), "rows left out")
    _warn(source, map(str, parts.notes), "notes")
    columns = [(c.field, c.header, f"{c.confidence:.0%}") for c in read.columns]
    print_table(out, table("", ["column", "header in the list", "sure"], columns, figures=(2,)))
    unused = f"; not used: {', '.join(read.unused)}" if read.unused else ""
    out.print(
        f"{source}: header in row {read.header_row}, {read.sheet}, decimal '{read.decimal}'{unused}", markup=False
    )
    of_all = found.assumptions
    quality = of_all.quality or of_all.board_quality or "each model's own"
    out.print(
        f"assumed of all: {of_all.temperature} around them, junctions and windings {of_all.rise} above it, applied "
        f"{of_all.stress:g} of the rated, quality {quality}, environment {explained(of_all.environment)}",
        markup=False,
    )
    kinds = [
        (
            kind or "not clear",
            str(len(of)),
            str(sum(one.part.quantity for one in of)),
            _rates(of),
            _assumed_in_words(of),
        )
        for kind, of in by_kind(found.parts).items()
    ]
    print_table(
        out, table("", ["kind", "rows", "parts", "λ", "assumed besides, in how many rows"], kinds, figures=(1, 2, 3))
    )
    for state in CHANGED:
        _several(out, state, _outcomes(found, state))
    _several(out, "removed", [one.name for one in found.removed if one.state == "removed"])
    _several(out, "not in the list", [f"{one.name}: {one.text}" for one in found.removed if one.state == "kept"])
    _several(out, "left out", map(str, parts.left_out))
    _several(out, "needs a rate", _outcomes(found, "needs a rate"))
    guesses = found.guesses
    _several(out, "a guess, by letters alone", [f"{one.outcome.name}: {one.part.recognised.kind}" for one in guesses])
    gone = sum(one.state == "removed" for one in found.removed)
    counts = ", ".join(f"{len(found.of_state(state))} {state}" for state in COUNTED)
    needing = len(found.of_state("needs a rate"))
    written = "nothing written (dry run)" if wishes.dry_run else str(design)
    guessed = f", of which {rate_text(total_rate(guesses))} is guessed by letters alone" if guesses else ""
    if of_all.board_quality == UNKNOWN:
        out.print(f"nobody has said its quality: λ is {rates_by_quality(*rate_range(found.parts))}", markup=False)
    out.print(
        f"{written}: {counts}, {gone} removed; {needing} need a rate; "
        f"λ {'at least ' if needing else ''}{_rates(found.parts)}{guessed}",
        markup=False,
    )


def _outcomes(found: ImportedList, state: State) -> list[str]:
    return [f"{one.outcome.name}: {one.outcome.text}" for one in found.of_state(state)]


def _rates(parts: Sequence[ImportedPart]) -> str:
    """What the parts may fail by: a range where their quality is unknown."""
    if all(one.hazard_rate is None for one in parts):
        return "–"
    low, high = rate_range(parts)
    return rate_text(total_rate(parts)) if low == high else f"{number_text(low)} … {rate_text(high)}"


def _assumed_in_words(parts: Iterable[ImportedPart]) -> str:
    own = {name: values for name, values in assumed_inputs(parts).items() if name not in OF_ALL}
    said = [(f"{name} {min(values)}" if len(values) == 1 else name, values) for name, values in own.items()]
    return ", ".join(f"{what} ({values.total()})" for what, values in said) or "–"


def _warn(source: Path, lines: Iterable[str], what: str) -> None:
    said = list(lines)
    for line in said[:MOST_LINES]:
        warn(f"{source.name}: {line}")
    if len(said) > MOST_LINES:
        warn(f"{source.name}: and {len(said) - MOST_LINES} more {what}; --json has them all")


def _several(out: Any, title: str, lines: Iterable[str]) -> None:
    said = list(lines)
    if said:
        out.print(f"{title} ({len(said)})", style="bold", markup=False)
    for line in said[:MOST_LINES]:
        out.print(f"  {line}", markup=False)
    if len(said) > MOST_LINES:
        out.print(f"  and {len(said) - MOST_LINES} more; --json has them all", markup=False)
