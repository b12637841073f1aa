"""The hazard models and accelerations by what they are of, as people call it."""

from __future__ import annotations

import re

from robophm.core.errors import PlugError, nearest
from robophm.core.table import Table
from robophm.hazard.acceleration import ACCELERATIONS
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Choice, Model

_KIND_OF = "(?:micro|opto|photo)?"
"""Prefixes that may stand before a word: a microcircuit is a circuit, but a thumbwheel switch no wheel."""


_SMALL = frozenset(["a", "an", "and", "for", "in", "of", "on", "or", "the", "to", "with"])
"""Words that name no part."""


def all_models() -> dict[str, Model]:
    """Hazard models by name, then accelerations."""
    return {name: handbook_model(name) for name in handbook_models()} | dict(ACCELERATIONS)


def find_models(kind: str | None = None) -> dict[str, Model]:
    """The models of a kind of part, such as "chip resistor", by name; of none all models.

    Those that are called so come before those that only speak of it.
    Raises PlugError, with the nearest known word, where there is none of that kind.
    """
    models = all_models()
    if kind is None:
        return models
    said = [word for word in kind.lower().split() if word not in _SMALL]
    wanted = [re.compile(rf"(?<![a-z]){_KIND_OF}{re.escape(word)}") for word in said]
    found = {
        name: model
        for name, model in models.items()
        if wanted and all(one.search(_words(name, model)) for one in wanted)
    }
    if not found:
        known = {word for name, model in models.items() for word in _names(name, model).split() if len(word) > 2}
        raise PlugError(f"no hazard model of '{kind}'{nearest(kind.lower(), known, ())}")

    def how(name: str) -> int:
        """Rank how a model matches: 0 by its own name, 1 by the name of a choice of its, 2 by its description."""
        said = (name.replace("_", " ").replace(".", " "), _names(name, models[name]))
        return next((i for i, text in enumerate(said) if all(one.search(text) for one in wanted)), len(said))

    return {name: found[name] for name in sorted(found, key=how)}


def _names(name: str, model: Model) -> str:
    """The names of a model and its choices, in lower case."""
    said = [name.replace("_", " ").replace(".", " ")]
    for entry in model.inputs.values():
        if isinstance(entry, Choice) and not entry.shared:
            said += [*entry.options, *entry.aliases]
    return " ".join(said).lower()


def _words(name: str, model: Model) -> str:
    """Everything that a model says of itself and its choices, in lower case."""
    said = [_names(name, model), model.formula, model.description, model.source.title]
    for entry in model.inputs.values():
        if isinstance(entry, Choice) and isinstance(entry.options, Table) and not entry.shared:
            said += entry.options.notes.values()
    return " ".join(said).lower()
