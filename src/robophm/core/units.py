"""Units at the edges: what a user writes becomes the one unit used inside (h, 1/h, km, °C, V …).

Inside robophm every number is in the unit that its docstring states. pint is loaded only here, and only for units
that are not among the usual ones: it takes a third of a second to load, which is longer than most commands work.
"""

from __future__ import annotations

import math
import re
from functools import lru_cache
from threading import Lock
from typing import TYPE_CHECKING, Any, NamedTuple

from robophm.core.errors import UnitError, nearest

if TYPE_CHECKING:
    from pint import UnitRegistry

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)\Z", re.ASCII | re.DOTALL)
# What may follow the number. pint's own grammar would compute 9**9**9; this one cannot be made to work hard.
_FACTOR = re.compile(r"\s*([*·/]?)\s*(?:(10\^-?\d{1,2}|1e-?\d{1,2}|1(?!\d))|([^\W\d]+|[%°Ω]\w?)(?:(?:\^|\*\*)(-?\d))?)")
_DIFFERENCES = {"delta_degC": "K", "delta_degF": "delta_degF"}
"""The unit of pint for each spelling of a difference of temperatures, which has no offset: 10 K are 10 delta_degC."""
_TEMPERATURES = ("degC", "degF", "K", *_DIFFERENCES)
_MISTAKEN = {"c": "degC", "f": "degF", "°": "degC", "deg": "degC", "deg c": "degC", "deg f": "degF",
             "grad": "degC"}  # fmt: skip
"""The unit of pint for each usual misspelling of a temperature, which pint itself would take for coulombs, farads, the
speed of light or an angle, or would not know."""
_SPAN = 2.0**20  # wide, so that the 273.15 of a temperature costs the scale no digits
_NAMES = ("h", "s", "min", "day", "FIT", "FPMH", "degC", "degF", "K", "V", "A", "W", "ohm", "uF", "m", "km",
          "m/s", "km/h", "cycle", "start", "percent", "eV", "Pa", "N", "rpm")  # fmt: skip


class Conversion(NamedTuple):
    """A linear map from a written unit to the inside one: ``inside = scale · written + offset``."""

    scale: float
    offset: float


_USUAL = {
    **{(unit, unit): Conversion(1.0, 0.0) for unit in (
        "", "h", "s", "min", "m", "km", "m/s", "km/h", "V", "A", "W", "N", "N*m", "eV", "degC", "delta_degC", "cycle",
        "1/h", "1/km", "1/m", "1/cycle", "1/start", "cycle/h", "start/h", "rad", "rad/s", "Pa")},
    **{(f"/{unit}", f"1/{unit}"): Conversion(1.0, 0.0) for unit in ("h", "km", "m", "cycle", "start")},
    **{(written, inside): Conversion(scale, 0.0) for inside, scales in {
        "": {"%": 0.01, "percent": 0.01},
        "h": {"s": 1 / 3600, "min": 1 / 60, "hour": 1.0, "hours": 1.0, "day": 24.0, "days": 24.0, "week": 168.0,
              "weeks": 168.0, "month": 730.5, "months": 730.5, "year": 8766.0, "years": 8766.0},
        "s": {"ms": 1e-3, "min": 60.0, "h": 3600.0},
        "1/h": {"FIT": 1e-9, "FPMH": 1e-6, "/10^6 h": 1e-6, "per hour": 1.0},
        "FPMH": {"1/h": 1e6},
        "m": {"km": 1e3},
        "km": {"m": 1e-3},
        "m/s": {"km/h": 1 / 3.6},
        "delta_degC": {"K": 1.0},
    }.items() for written, scale in scales.items()},
    ("°C", "degC"): Conversion(1.0, 0.0),
    ("K", "degC"): Conversion(1.0, -273.15),
}  # fmt: skip
"""The conversions of the usual pairs of a written unit and the one used inside, as pint makes them."""


def _registry() -> UnitRegistry[Any]:
    with _MAKING:  # units of two registries cannot be compared, so that threads must share one
        return _made()


_MAKING = Lock()


@lru_cache(maxsize=1)
def _made() -> UnitRegistry[Any]:
    import pint

    registry: UnitRegistry[Any] = pint.UnitRegistry(autoconvert_offset_to_baseunit=True, cache_folder=None)
    registry.define("FIT = 1e-9 / hour")
    registry.define("FPMH = 1e-6 / hour")
    registry.define("cycle_of_use = [cycle_of_use] = cycle = cycles")  # not pint's 2π radians
    registry.define("start = [start] = _ = starts")
    return registry


@lru_cache(maxsize=4096)
def conversion(written: str, inside: str) -> Conversion:
    """The map from a unit that a user wrote to the unit used inside.

    Raises UnitError where either is no unit, or where they measure different things.
    """
    return _USUAL.get((written, inside)) or _of_pint(written, inside)


def _of_pint(written: str, inside: str) -> Conversion:
    import pint

    if inside in _TEMPERATURES and (meant := _MISTAKEN.get(written.casefold())):
        what, meant = ("a difference of temperatures", "K") if inside in _DIFFERENCES else ("temperature", meant)
        raise UnitError(f"'{written}' is no unit of {what}; did you mean '{meant}'?")
    (power, source), (inside_power, target) = _parse(written), _parse(inside)
    try:
        low = _registry().Quantity(0.0, source).to(target).magnitude
        high = _registry().Quantity(_SPAN, source).to(target).magnitude
    except pint.PintError:
        hint = f"; a difference of temperatures is in '{_DIFFERENCES[inside]}'" if inside in _DIFFERENCES else ""
        raise UnitError(f"unit '{written or 'none'}' does not measure what '{inside or 'none'}' does{hint}") from None
    return Conversion(float(high - low) / _SPAN * 10.0 ** (power - inside_power), float(low))


def _parse(unit: str) -> tuple[int, Any]:
    """The power of ten and the unit of a text such as '/10^6 h' (all after a leading stroke is below it)."""
    import pint

    text = unit.strip()
    inverse = re.match(r"(?:1\s*/|/|per\s)", text)
    text = re.sub(r"\sper\s", "/", text[inverse.end() :] if inverse else text)
    power, result, at = 0, _registry().Unit(""), 0
    while at < len(text):
        match = _FACTOR.match(text, at)
        if not match or len(text) > 60:
            raise UnitError(f"'{unit[:60]}' is not a unit; expected e.g. 'h', 'FIT', 'degC', 'km/h'")
        at = match.end()
        operator, ten, name, exponent = match.groups()
        sign = -1 if operator == "/" else 1
        if ten:
            power += sign * int(re.split(r"[\^e]", f"{ten}^0")[1])
            continue
        if name in ("degC", "°C", "degF", "°F") and name != unit.strip():
            name = f"delta_{name}"  # a share of a temperature is of a difference: '5 °C/W'
        try:
            result = result * _registry().Unit(name) ** (sign * int(exponent or 1))
        except (pint.PintError, AttributeError, ValueError):
            raise UnitError(f"unknown unit '{name}'{nearest(name, _NAMES)}") from None
    return (-power, result**-1) if inverse else (power, result)


def quantity(text: object, inside: str) -> float:
    """A written quantity ('12 FIT', '0.3 FPMH', '5.8e-6 /h', '0.3 /10^6 h', '25 degC') in the unit used inside.

    A bare number is taken only where the inside unit is none. Raises UnitError otherwise, and for text that is
    not a finite number with a unit.
    """
    if isinstance(text, bool) or not isinstance(text, int | float | str):
        raise UnitError(f"{text!r:.60} is not a quantity; expected a number with the unit of '{inside or 'none'}'")
    if isinstance(text, int | float):
        value, unit = _finite(text), ""
    else:
        match = _NUMBER.match(text)
        if not match:
            example = f"1.5 {inside}".rstrip()
            raise UnitError(f"'{text[:60]}' is not a number with a unit; expected e.g. '{example}'")
        value, unit = _finite(match[1]), match[2].strip()
    if not unit and inside:
        raise UnitError(f"'{text!s:.60}' has no unit; expected e.g. '{text!s:.60} {_DIFFERENCES.get(inside, inside)}'")
    scale, offset = conversion(unit, inside)
    whole = round(1 / scale)  # 12 FIT is 12 / 10⁹, which rounds once; 12 · 1e-9 rounds twice
    exact = scale < 1 and abs(whole * scale - 1) < 1e-15
    return _finite((value / whole if exact else value * scale) + offset)


def told(text: str, inside: str | None) -> float:
    """A number as a device tells it in a text, '23.5 C', '48.1 V' or '12 %', in the unit in which it is wanted.

    A bare number is in that unit. NaN where the text is no number, or has a unit of something else, or none is wanted.
    """
    match = _NUMBER.match(text)
    if not match:
        return math.nan
    if not (unit := match[2].strip()):
        return float(match[1])
    try:
        scale, offset = _of_device(unit, inside)
    except UnitError:
        return math.nan
    return float(match[1]) * scale + offset


@lru_cache(maxsize=4096)
def _of_device(unit: str, inside: str | None) -> Conversion:
    """The map from a unit as devices spell it: C is no coulomb where a temperature is wanted. Raises UnitError."""
    if inside is None:
        raise UnitError(f"'{unit:.60}' where no unit is wanted")
    plain = " ".join(unit.strip("[]()").split())
    if inside in _TEMPERATURES and (meant := {**_MISTAKEN, "celsius": "degC"}.get(plain.casefold())):
        plain = meant
    try:
        return conversion(plain, inside)
    except UnitError:
        return conversion(plain.casefold(), inside)


def in_unit(value: float, inside: str, unit: str) -> float:
    """A number that is in ``inside``, in the unit in which somebody wants to see it.

    Raises UnitError where that measures something else: a rate per cycle has no FIT, which are per hour.
    """
    try:
        scale, offset = conversion(inside, unit)
    except UnitError as error:
        below = inside.partition("/")[2]
        raise UnitError(f"{error}; expected e.g. '{inside}'" + (f" or '/10^6 {below}'" if below else "")) from None
    return value * scale + offset


def _finite(number: float | str) -> float:
    try:
        value = float(number)
    except OverflowError:  # an integer of hundreds of digits
        value = math.inf
    if not math.isfinite(value):
        raise UnitError(f"{number if isinstance(number, str) else value:.60} is not a finite number")
    return value
