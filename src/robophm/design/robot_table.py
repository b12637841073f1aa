"""A robot as a table in a notebook: its parts, their nominal rates, and the signals that they listen to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from robophm.core.html_table import html_table


def robot_table(title: str, components: Iterable[Any], units: Mapping[str, str]) -> str:
    """Return components as HTML; ``units`` of rates by clock. A rate that nobody knows is said to be unknown."""
    return html_table(title, ("part", "quantity", "nominal rate", "signals"), _rows(components, units))


def _rows(components: Iterable[Any], units: Mapping[str, str]) -> Iterator[tuple[str, str, str, str]]:
    for part in components:
        rates = ("unknown" if one.unknown else f"{one.rate:.4g} /{units[one.clock]}" for one in part.modes)
        stresses = (stress for mode in part.modes for stress in mode.measured)
        heard = dict.fromkeys(channel.signal for stress in stresses for channel in stress.channels.values())
        yield part.path, str(part.quantity), " + ".join(rates), ", ".join(heard)
