"""Quantities in the words of a row, in whatever way people write them, and what several sources make of one."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from robophm.core.units import quantity
from robophm.design.importers.bom.codes import coded, preferred, same, written
from robophm.design.importers.bom.columns import Decimal

Patterns = tuple[re.Pattern[str], ...]

NUMBER = r"(?<![\w.])([0-9]{1,9}(?:\.[0-9]{1,6})?|\.[0-9]{1,6})"
END = r"(?![^\W_])"
CAPACITANCE: Patterns = (
    re.compile(rf"{NUMBER}\s?([pnuµμmPNU]?)[Ff]{END}"),
    re.compile(rf"{NUMBER}\s?([pnuµμPNU]){END}"),
)
RESISTANCE: Patterns = (
    re.compile(rf"{NUMBER}\s?([uµμmkKMG]?)\s?(?:Ω|\u2126|[oO]hms?|OHMS?){END}"),
    re.compile(rf"{NUMBER}([mkKMGRE]){END}"),
    re.compile(rf"{NUMBER}(m)R{END}"),
)
INDUCTANCE: Patterns = (
    re.compile(rf"{NUMBER}\s?([pnuµμmPNUM])[Hh]{END}"),
    re.compile(rf"{NUMBER}([nuµμNU]){END}"),
)
VOLTAGE: Patterns = (
    re.compile(rf"{NUMBER}\s?(k?)[Vv](?:DC|dc)?{END}(?!\s(?:decoupling|rails?|suppl(?:y|ies)|line|side)(?![^\W_]))"),
)
"""Voltages that are rated: not those of the rail that a capacitor decouples."""
CURRENT: Patterns = (re.compile(rf"{NUMBER}\s?([mu]?)A{END}"),)
FREQUENCY: Patterns = (re.compile(rf"{NUMBER}\s?([kKMG]?)[hH][zZ]{END}"),)
POWER: Patterns = (
    re.compile(
        rf"(?<![\w./])([0-9]{{1,9}}(?:\.[0-9]{{1,6}})?(?:/[0-9]{{1,2}})?|\.[0-9]{{1,6}})\s?(m?)W{END}"
        r"(?!\s?(?:at|@)\s?[0-9.]+\s?m?[AV](?![^\W_]))"
    ),
)
"""Powers that are rated, also at a temperature; at a current or a voltage they are what it dissipates."""
MEASURED: Mapping[str, tuple[Patterns, str]] = {
    "capacitor": (CAPACITANCE, "F"),
    "resistor": (RESISTANCE, "ohm"),
    "inductor": (INDUCTANCE, "H"),
    "crystal": (FREQUENCY, "Hz"),
}
"""Patterns of the value of each kind of part, and its SI unit.

The first pattern wants the unit itself; the others take a prefix alone, as people write it.
"""

_SCALE = {"µ": "u", "μ": "u", "K": "k", "R": "", "E": "", "P": "p", "N": "n", "U": "u"}
"""The SI prefix for each letter that is used for one; M is a million, but in henries a thousandth."""

_LETTER_AS_POINT = re.compile(
    r"(?<![\w.])([0-9]{1,4})([pnuµμmkKMGRVPNU])([0-9]{1,3})(?=[FfHhΩ]?(?![^\W_]))"
)  # 4u7, 6V3
_LETTER_FIRST = re.compile(r"([Rrpnuµμ])([0-9]{1,4})(?=[FfHhΩ]?(?:[\s,/]|$))")  # R005, u1


def plain(text: str, decimal: Decimal) -> str:
    """A text whose numbers have points, and none a letter for its point."""
    return _LETTER_AS_POINT.sub(r"\1.\3\2", with_points(text, decimal))


def plain_value(text: str, decimal: Decimal) -> str:
    """A cell of values likewise, which may begin with the letter."""
    text = re.sub(r"(?<=[0-9]) (?=[pnuµμkKMR]$)", "", text)  # 100 n
    if match := _LETTER_FIRST.match(text):
        text = f"0.{match[2]}{match[1].upper() if match[1] in 'rR' else match[1]}{text[match.end() :]}"
    return plain(text, decimal)


def with_points(text: str, decimal: Decimal) -> str:
    """A text whose numbers have points and no thousands: 4,7 and 1.000 in a list with commas, 1,000 in another."""
    if decimal == "," or re.fullmatch(r"[0-9]{1,3},[0-9]{1,2}\s?[A-Za-zµμΩ]+", text):
        text = re.sub(
            r"(?<![\w.,])[1-9][0-9]{0,2}(?:\.[0-9]{3})+(?![0-9.])", lambda match: match[0].replace(".", ""), text
        )
        return re.sub(r"(?<![\w.,])(0|[1-9][0-9]{0,3}),([0-9]{1,6})(?![0-9,])", r"\1.\2", text)
    return re.sub(r"(?<![\w.,])[1-9][0-9]{0,2}(?:,[0-9]{3})+(?![0-9,])", lambda match: match[0].replace(",", ""), text)


def with_unit(text: str, unit: str) -> str:
    """A bare number of a column whose unit is clear, with it."""
    return f"{text} {unit}" if re.fullmatch(r"[0-9]{1,9}(\.[0-9]{1,6})?|\.[0-9]{1,6}", text) else text


def first(patterns: Patterns, unit: str, *texts: str) -> str | None:
    """The first quantity of a kind, as '4.7 uF'."""
    for text in texts:
        for pattern in patterns:
            if match := pattern.search(text):
                number, _, below = match[1].partition("/")  # 1/10 W
                if below and float(below):
                    number = f"{float(number) / float(below):.4g}"
                number = f"0{number}" if number.startswith(".") else number
                scale = match[2]
                return f"{number} {'m' if (scale, unit) == ('M', 'H') else _SCALE.get(scale, scale)}{unit}"
    return None


def without_numbers(text: str) -> str:
    """A text without what is written like a part's number: the 3R3 of XYZ0630-3R3-M is no resistance."""
    return re.sub(r"(?<!\S)(?=\S*[A-Za-z])(?=\S*[0-9])[A-Za-z0-9.]{3,}-\S+", "", text)


def measured(value: str) -> tuple[frozenset[str], frozenset[str]]:
    """The kinds that a value can be of, and those that its unit itself says: 10u is of two kinds, 10uF of one."""
    value = without_numbers(value).partition("@")[0]  # 600R@100MHz
    may = {kind for kind, (patterns, unit) in MEASURED.items() if first(patterns, unit, value)}
    does = {kind for kind, (patterns, unit) in MEASURED.items() if first(patterns[:1], unit, value)}
    return frozenset(may), frozenset(does)


class Value(NamedTuple):
    """The value of one quantity after several sources of it were compared."""

    text: str | None
    why: str = ""
    """The source of the value, where it is not the list's own column of values; else ""."""
    contradiction: str = ""


def value_of(kind: str, value: str, words: str, number: str | None) -> Value:
    """The quantity of a passive part by its value, its words and its maker's number, each of which may say none.

    Two that agree are believed, else the number, by which parts are bought; and that one says otherwise is told.
    """
    patterns, unit = MEASURED[kind]
    own, why = first(patterns, unit, without_numbers(value)), ""
    if own is None and (bare := re.fullmatch(r"([0-9]{3})[A-Z]?", value)):
        own, why = _bare_code(kind, bare[1])
    if own is None and kind == "resistor":
        own = first(patterns, unit, with_unit(value, unit))  # 100 in a column of values is ohms
    said = {"value": own, "words": first(patterns, unit, words), "maker's number": number}
    known = {source: text for source, text in said.items() if text}
    if not known:
        return Value(None)
    numbers = {source: quantity(text, unit) for source, text in known.items()}
    agreed = [source for source in numbers if sum(same(numbers[source], other) for other in numbers.values()) > 1]
    taken = agreed[0] if agreed else "maker's number" if "maker's number" in known else next(iter(known))
    others = [f"its {source} {text}" for source, text in known.items() if not same(numbers[source], numbers[taken])]
    contradiction = f"by its {taken} {known[taken]}, by {', '.join(others)}; {known[taken]} is taken" if others else ""
    return Value(known[taken], why if taken == "value" else "" if said["value"] else f"by its {taken}", contradiction)


def _bare_code(kind: str, digits: str) -> tuple[str | None, str]:
    """What three digits alone mean: 104 of a capacitor is 100 nF; of a resistor only where nobody makes 104 ohms."""
    number = coded(digits)
    if number is None or digits.endswith("0") or (kind == "resistor" and preferred(int(digits))):
        return None, ""
    if kind in ("capacitor", "resistor"):
        text = written(number * (1e-12 if kind == "capacitor" else 1.0), MEASURED[kind][1])
        return text, f"as the code {digits}"
    return None, ""
