"""``robophm models``: every hazard model and acceleration by what it is of, and the reference page made of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Annotated

import typer

from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import PlugError, nearest
from robophm.core.table import Table
from robophm.hazard.acceleration import ACCELERATIONS
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Choice, Input, Model, Note

_KIND_OF = "(?:micro|opto|photo)?"
"""What may stand before a word: a microcircuit is a circuit, but a thumbwheel switch no wheel."""

_MANY = 12  # options, beyond which a table names them one by one


def all_models() -> dict[str, Model]:
    """Hazard models by name, then accelerations."""
    return {name: handbook_model(name) for name in handbook_models()} | dict(ACCELERATIONS)


def find(kind: str | None) -> dict[str, Model]:
    """The models of a kind of part, as people call it. Raises PlugError with the nearest known word."""
    models = all_models()
    if kind is None:
        return models
    wanted = [re.compile(rf"(?<![a-z]){_KIND_OF}{re.escape(word)}") for word in kind.lower().split()]
    found = {name: model for name, model in models.items() if all(one.search(_words(name, model)) for one in wanted)}
    if not found:
        known = {word for name, model in models.items() for word in _names(name, model).split()}
        listed = {name.rpartition(".")[2] for name in models}
        raise PlugError(f"no hazard model of '{kind}'{nearest(kind.lower(), known, listed)}")
    return found


def _names(name: str, model: Model) -> str:
    """What a model and its choices are called, in lower case."""
    said = [name.replace("_", " ").replace(".", " ")]
    for entry in model.inputs.values():
        if isinstance(entry, Choice):
            said += [*entry.options, *entry.aliases]
    return " ".join(said).lower()


def _words(name: str, model: Model) -> str:
    """Everything that a model says of itself and its choices, in lower case."""
    said = [_names(name, model), model.formula, model.description, model.source.title]
    for entry in model.inputs.values():
        if isinstance(entry, Choice) and isinstance(entry.options, Table):
            said += entry.options.notes.values()
    return " ".join(said).lower()


def reference() -> Iterator[str]:
    """The reference page, line by line in Markdown."""
    yield "# Hazard models and accelerations"
    yield ""
    yield "Made by `robophm models --reference` from the models' own declarations. In a design a model is"
    yield "`hazard: {model: NAME, inputs: {…}}`, an acceleration `acceleration: {model: NAME, …}`. *Checked* says how"
    yield "sure the transcription is. Any number may be bound to a sensor. Beyond a range a design is refused, and a"
    yield "live value is flagged."
    for name, model in all_models().items():
        yield from ("", f"## {name}", "", model.description)
        yield from ("", f"`{model.formula}` [{model.unit or 'factor'}]", "")
        yield f"{model.source}. Checked: {model.source.status}."
        yield from ("", "| input | takes | default | meaning |", "|---|---|---|---|")
        for key, entry in model.inputs.items():
            yield f"| `{key}` | {_takes(entry)} | {_default(entry)} | {_cell(entry.description)} |"
        for key, entry in model.inputs.items():
            yield from _options(key, entry)


def _takes(entry: Input) -> str:
    if isinstance(entry, Choice):
        return ", ".join(entry.options) if len(entry.options) <= _MANY else f"one of {len(entry.options)}, below"
    if isinstance(entry, Note):
        return "words"
    return f"whole, {entry.span}" if entry.whole else entry.span


def _default(entry: Input) -> str:
    if entry.default is None:
        return "" if isinstance(entry, Choice) or entry.required else "optional"
    return entry.default if isinstance(entry, Choice) else f"{entry.default:g} {entry.unit}".rstrip()


def _options(key: str, entry: Input) -> Iterator[str]:
    """What many or annotated options mean, and what else they are called."""
    if not isinstance(entry, Choice):
        return
    notes = entry.options.notes if isinstance(entry.options, Table) else {}
    if len(entry.options) > _MANY:
        told = (f"{option} ({note})" if (note := _cell(notes.get(option, ""))) else option for option in entry.options)
        yield from ("", f"`{key}`: {', '.join(told)}.")
    if entry.aliases:
        yield from (
            "",
            f"`{key}` is also written: {', '.join(f'{a} = {b}' for a, b in sorted(entry.aliases.items()))}.",
        )


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def print_reference() -> None:
    """The page on stdout."""
    refuse_unused("the reference page", ("reference",), as_json=False)
    typer.echo("\n".join(reference()))


def command(
    kind: Annotated[str | None, typer.Argument(help="of part, e.g. motor, 'chip resistor'; none lists all")] = None,
    reference: Annotated[bool, typer.Option("--reference", help="print the reference page, Markdown")] = False,
    as_json: Json = False,
) -> None:
    """The hazard models for a kind of part."""
    if reference:
        print_reference()
    else:
        run(kind, as_json=as_json)


def run(kind: str | None, *, as_json: bool) -> None:
    """List the models of a kind of part. Raises PlugError."""
    found = find(kind)
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
    print_table(console(), table("Hazard models and accelerations", ("model", "formula", "source"), rows))
