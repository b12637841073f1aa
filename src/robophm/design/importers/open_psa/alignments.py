"""Alignments of an Open-PSA model: the phases of a mission, each with its share of the time and its house events."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from robophm.core.markup import Element
from robophm.design.importers.open_psa.event_trees import house_set
from robophm.design.importers.open_psa.names import Names, name_of

_SUM = 1e-4
"""How far from one the shares of the time may add up to: they are written with few digits."""


class Phase(NamedTuple):
    """A phase of a mission: its name, its share of the mission time, and the house events that are set in it."""

    name: str = ""
    fraction: float = 1.0
    houses: Mapping[str, bool] = {}


def phases(alignments: Iterable[Element], events: Names) -> Iterator[Phase]:
    """Yield the phases of each alignment; one without a name where there are none. Raises DesignError."""
    seen: set[str] = set()
    for said in alignments:
        if name_of(said) in seen:
            raise said.fault(f"alignment '{name_of(said)}' is defined twice")
        seen.add(name_of(said))
        found: dict[str, Phase] = {}
        for one in said.inside():
            if one.tag != "define-phase" or name_of(one) in found:
                raise one.fault(f"'{one.tag}' of '{name_of(one)}'; expected define-phase, each with a name of its own")
            found[name_of(one)] = Phase(name_of(one), _fraction(one), _houses(one, events))
        if abs(sum(phase.fraction for phase in found.values()) - 1) > _SUM:
            raise said.fault(f"the time fractions of alignment '{name_of(said)}' do not add up to 1")
        yield from found.values()
    if not seen:
        yield Phase()


def _fraction(said: Element) -> float:
    text = said.attributes.get("time-fraction", "")
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value <= 1:
        raise said.fault(f"phase '{name_of(said)}' has the time fraction {text!r:.60}; expected above 0, at most 1")
    return value


def _houses(said: Element, events: Names) -> dict[str, bool]:
    houses: dict[str, bool] = {}
    for one in said.inside():
        if one.tag != "set-house-event":
            raise one.fault(f"'{one.tag}' is not taken in a phase; expected set-house-event")
        houses |= house_set(events, one)
    return houses
