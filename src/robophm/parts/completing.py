"""A component of a design with the entry of the library that it names: what is its own wins."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from robophm.parts.entries import FIGURES, Entry
from robophm.parts.searching import part

_OF_THE_FIGURE = {*FIGURES, "hazard", "failure_modes", "uncertainty", "source"}
"""Keys that a part's own figure replaces; how the part ages, its clock and what stress does to it stay."""


def completed(component: Mapping[str, Any]) -> dict[str, Any]:
    """Return a component of a design that says ``part: name``, completed by what the entry of that name says.

    A ``rate`` (``mtbf`` …) of its own takes the place of the entry's with its uncertainty and source; a ``hazard``,
    ``failure_modes`` or the rate ``unknown`` that of all that the entry says; any other key that of this key. The
    entry's environment is not among it: it holds where no level of the design states one.
    Raises PlugError where the library has no such entry.
    """
    entry = part(component["part"])
    own = {key for key, said in component.items() if said is not None}
    given = _sourced(entry)
    if own & {"hazard", "failure_modes"} or component.get("rate") == "unknown":
        given = {}
    elif own & {*FIGURES}:
        given = {key: said for key, said in given.items() if key not in _OF_THE_FIGURE}
    if modes := given.get("failure_modes"):
        mine = own & {"uncertainty", "source"}
        given["failure_modes"] = {n: {k: v for k, v in mode.items() if k not in mine} for n, mode in modes.items()}
    return {**given, **component}


def _sourced(entry: Entry) -> dict[str, Any]:
    """The component of an entry, each of its failure modes with where its rate is from."""
    source = {"source": entry.origin}
    said = {key: value for key, value in entry.part.items() if key != "environment"}
    if modes := said.get("failure_modes"):
        return {**said, "failure_modes": {name: {**source, **mode} for name, mode in modes.items()}}
    return source | said
