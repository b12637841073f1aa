"""The reference page of the hazard models, made from the models' own declarations."""

from __future__ import annotations

from collections.abc import Iterator

from robophm.core.table import Table
from robophm.hazard.environments import SOURCE, rows
from robophm.hazard.model import Choice, Input, Note
from robophm.hazard.search import all_models

_MANY = 12  # options, beyond which a table names them one by one


def reference() -> Iterator[str]:
    """The reference page, line by line in Markdown."""
    yield "# Hazard models and accelerations"
    yield ""
    yield "Made by `robophm models --reference` from the models' own declarations. In a design a model is"
    yield "`hazard: {model: NAME, inputs: {…}}`, an acceleration `acceleration: {model: NAME, …}`. *Checked* says how"
    yield "sure the transcription is. Any number may be bound to a sensor. Beyond a range a design is refused, and a"
    yield "live value is flagged."
    yield from _environments()
    for name, model in all_models().items():
        yield from ("", f"## {name}", "", model.description)
        yield from ("", f"`{model.formula}` [{model.unit or 'factor'}]", "")
        yield f"{model.source}. Checked: {model.source.status}."
        yield from ("", "| input | takes | default | meaning |", "|---|---|---|---|")
        for key, entry in model.inputs.items():
            yield f"| `{key}` | {_takes(entry)} | {_default(entry)} | {_cell(entry.description)} |"
        for key, entry in model.inputs.items():
            yield from _options(key, entry)


def _environments() -> Iterator[str]:
    """What all models mean by an environment, once."""
    yield from ("", "## Environments", "", f"Where a part works, in every model that asks for it: {SOURCE}.", "")
    yield from ("| symbol | handbook | meaning | or in words |", "|---|---|---|---|")
    yield from (f"| {' | '.join(map(_cell, row))} |" for row in rows())


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
    """The meanings of many or annotated options, and what else they are called."""
    if not isinstance(entry, Choice):
        return
    notes = entry.options.notes if isinstance(entry.options, Table) else {}
    if len(entry.options) > _MANY:
        told = (f"{option} ({note})" if (note := _cell(notes.get(option, ""))) else option for option in entry.options)
        yield from ("", f"`{key}`: {', '.join(told)}.")
    if entry.aliases and not entry.shared:
        yield from (
            "",
            f"`{key}` is also written: {', '.join(f'{a} = {b}' for a, b in sorted(entry.aliases.items()))}.",
        )


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
