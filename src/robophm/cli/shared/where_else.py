"""Hints to the other list of parts, where one has nothing: the library and the handbooks' models."""

from __future__ import annotations

from robophm.core.errors import PlugError
from robophm.hazard.search import find_models
from robophm.parts import search

MOST = 3
"""Names that a hint has."""


def in_library(words: str) -> str:
    """Return the end of a sentence that names entries of the library; "" where it has none."""
    return _hint("the library of parts has", [entry.name for entry in search(words)], f"robophm parts {words}")


def in_handbooks(words: str) -> str:
    """Return the end of a sentence that names models of handbooks; "" where there are none."""
    try:
        names = list(find_models(words))
    except PlugError:
        return ""
    return _hint("handbooks rate", names, f"robophm models {words}")


def _hint(said: str, names: list[str], command: str) -> str:
    some = f"{', '.join(names[:MOST])}{' …' if len(names) > MOST else ''}"
    return f"; {said} {some}: {command}" if names else ""
