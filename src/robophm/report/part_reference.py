"""The reference page of the library of robot parts, made from its entries."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Any

from robophm.parts import FIGURES, GRADES, Entry, library


def reference() -> Iterator[str]:
    """The reference page, line by line in Markdown."""
    entries = library().values()
    yield "# The library of robot parts"
    yield ""
    yield f"Made by `robophm parts --reference` from the {len(entries)} entries. In a design an entry is `part: NAME`;"
    yield "`robophm parts NAME` prints it in full, with its reasoning; how to use the library, and add to it, is in"
    yield "[the guide](../guides/parts.md)."
    yield ""
    yield "; ".join(f"**{grade}**: {means}" for grade, means in GRADES.items()) + "."
    for kind, some in groupby(entries, key=lambda entry: entry.kind):
        yield from ("", f"## {kind.replace('_', ' ').capitalize()}", "")
        yield from ("| part | what it is | fails by | grade | source |", "|---|---|---|---|---|")
        for entry in some:
            cells = (f"`{entry.name}`", entry.title, figures(entry), entry.grade, entry.source)
            yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def figures(entry: Entry) -> str:
    """Return how often a part fails, as its entry states it, on one line."""
    modes = entry.part.get("failure_modes")
    if not modes:
        return _figure(entry.part)
    return "; ".join(f"{name} {_figure(mode)}" for name, mode in modes.items())


def _figure(mode: Mapping[str, Any]) -> str:
    if "hazard" in mode:
        return str(mode["hazard"].get("model", "by a formula"))
    return next(f"{key} {mode[key]}" for key in FIGURES if key in mode)
