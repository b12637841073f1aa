"""``robophm models``: every hazard model and acceleration by what it is of, and the reference page made of them."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.unused import refuse_unused
from robophm.cli.shared.where_else import in_library
from robophm.core.errors import PlugError
from robophm.hazard.environments import SOURCE, rows
from robophm.hazard.qualities import QUALITIES, VITA
from robophm.hazard.search import find_models
from robophm.report.model_reference import reference


def print_reference() -> None:
    """Print the reference page on stdout."""
    refuse_unused("the reference page", ("reference",), as_json=False)
    typer.echo("\n".join(reference()))


def print_environments(*, as_json: bool) -> None:
    """Print the environments that designs and models know: symbol, name in the handbook, meaning, words for it."""
    if as_json:
        keys = ("symbol", "name", "meaning", "words")
        print_json({"source": str(SOURCE), "environments": [dict(zip(keys, row, strict=True)) for row in rows()]})
        return
    print_table(console(), table(f"Environments ({SOURCE})", ("symbol", "handbook", "meaning", "or in words"), rows()))


def print_qualities(*, as_json: bool) -> None:
    """Print the words by which a design states the quality of a whole robot or board, each with its meaning."""
    if as_json:
        rows = [{"quality": said, "meaning": meaning} for said, meaning in QUALITIES.items()]
        print_json({"source": str(VITA), "qualities": rows})
        return
    print_table(console(), table("Qualities of a whole robot or board", ("quality", "meaning"), QUALITIES.items()))


def command(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            help="words for a part, e.g. motor, chip resistor; default: all models; environment, quality: their words"
        ),
    ] = None,
    reference: Annotated[bool, typer.Option("--reference", help="print the reference page as Markdown")] = False,
    as_json: Json = False,
) -> None:
    """List the hazard models for a kind of part."""
    kind = " ".join(words) if words else None
    if reference:
        print_reference()
    elif kind in ("environment", "environments"):
        print_environments(as_json=as_json)
    elif kind in ("quality", "qualities"):
        print_qualities(as_json=as_json)
    else:
        run(kind, as_json=as_json)


def run(kind: str | None, *, as_json: bool) -> None:
    """List the models of a kind of part. Raises PlugError."""
    try:
        found = find_models(kind)
    except PlugError as error:
        raise PlugError(f"{error}{in_library(kind or '')}") from None
    if as_json:
        print_json({
            "models": [
                {"name": name, "formula": model.formula, "unit": model.unit, "description": model.description,
                 "source": str(model.source), "status": model.source.status}
                for name, model in found.items()
            ]
        })  # fmt: skip
        return
    rows = [(name, model.formula, f"{model.source} ({model.source.status})") for name, model in found.items()]
    out = console()
    print_table(out, table("Hazard models and accelerations", ("model", "formula", "source"), rows))
    if kind and (hint := in_library(kind)):
        out.print(hint.removeprefix("; "), markup=False, soft_wrap=True)
