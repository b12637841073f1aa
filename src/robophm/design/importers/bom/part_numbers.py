"""Part numbers of makers decoded by their published ordering codes: kind, size, value, tolerance, rated voltage.

A number that no series fits says nothing.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple

from robophm.design.importers.bom.codes import coded, written
from robophm.design.importers.bom.part_series import SERIES, Series


class Decoded(NamedTuple):
    """A part number, understood."""

    number: str
    kind: str
    facts: Mapping[str, str]


_UNITS = {
    "capacitor": ("capacitance", "F"), "resistor": ("resistance", "ohm"), "resistor network": ("resistance", "ohm"),
    "thermistor": ("resistance", "ohm"), "inductor": ("inductance", "H"),
}  # fmt: skip
_TOLERANCES = {"B": "0.1 %", "C": "0.25 %", "D": "0.5 %", "F": "1 %", "G": "2 %", "J": "5 %", "K": "10 %", "M": "20 %"}
_POWER = {"12": "0.5 W", "14": "0.25 W", "18": "0.125 W", "25": "0.25 W", "50": "0.5 W"}
_ORDERED = re.compile(r"^[0-9]{2,3}-(?=[A-Z0-9]{2,})|(?:CT|TR|DKR)?-ND$")
"""A pattern of the prefixes and suffixes that distributors add to a maker's number: 81-GRM188…, CF14JT10K0CT-ND."""


def part_number(*cells: str) -> Decoded | None:
    """The first part number in some cells that a series fits."""
    for cell in cells:
        for word in _words(cell):
            if found := _decoded(word):
                return found
    return None


def _words(cell: str) -> Iterator[str]:
    for word in re.split(r"[\s,;|/]+", cell):
        if 7 <= len(word) <= 40 and any(letter.isdigit() for letter in word):
            yield word.upper()
            yield _ORDERED.sub("", word.upper())


@lru_cache(maxsize=1 << 14)
def _decoded(word: str) -> Decoded | None:
    for series in SERIES:
        if (match := series.pattern.fullmatch(word)) and (facts := _facts(series, match.groupdict())) is not None:
            return Decoded(word, series.kind, facts)
    return None


_GROUPS: Mapping[str, tuple[str, Callable[[str], str]]] = {
    "size": ("size", str),
    "tolerance": ("tolerance", lambda letter: _TOLERANCES.get(letter, "")),
    "volts": ("rated_voltage", lambda volts: f"{volts} V"),
    "dielectric": ("dielectric", lambda name: "C0G" if name in ("COG", "NPO", "NP0") else name),
    "power": ("rated_power", lambda code: _POWER[code]),
}


def _facts(series: Series, groups: Mapping[str, str | None]) -> dict[str, str] | None:
    """What a number says; None where its characters are none of the series' after all."""
    facts = dict(series.facts)
    for group, said in groups.items():
        if not said:
            continue
        if group in ("value", "ohms"):
            tight = series.kind in ("resistor", "resistor network") and len(said) == 4
            number = float(said) if group == "ohms" and said.isdigit() else coded(said, tight=tight)
            if number is None:
                return None
            name, unit = _UNITS[series.kind]
            facts[name] = written(number * series.scale, unit)
        elif group not in series.tables or said in series.tables[group]:
            name, text = _GROUPS[group]
            facts[name] = text(series.tables.get(group, {}).get(said, said))
        elif group in ("size", "volts"):
            return None
    return {name: text for name, text in facts.items() if text}
