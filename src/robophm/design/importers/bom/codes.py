"""How makers and the EIA write a value in a few characters: 104 is 100 nF, 4K7 is 4.7 kΩ, 4R7 is 4.7 of anything."""

from __future__ import annotations

import math
import re

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"), (1e-12, "p"))
_POINTS = {"R": 1.0, "K": 1e3, "M": 1e6, "G": 1e9, "L": 1e-3, "N": 1e-3}
"""The factor of each letter that stands in place of the decimal point: 4K7 is 4.7 · 10³.

L in ohms, and N in microhenries, is a thousandth.
"""

_BELOW = {"9": -1, "8": -2, "J": -1, "K": -2, "L": -3}
"""Last characters of four that divide: 5109 and 510J are 51.0."""

_WITH_POINT = re.compile(r"([0-9]*)([RKMGLN])([0-9]*)")


def written(value: float, unit: str) -> str:
    """A value with the prefix that engineers would use: 1e-7 F is '100 nF'."""
    scale, prefix = next((one for one in _PREFIXES if abs(value) >= one[0] * (1 - 1e-9)), (1.0, ""))
    return f"{value / scale:.6g} {prefix}{unit}"


def coded(code: str, *, tight: bool = False) -> float | None:
    """The number of a code: two digits, or three where it is of four, and a power of ten; or a letter for the point.

    Capacitors mean pF by it, resistors ohms, inductors µH. ``tight`` codes end in 9 and 8, or J, K and L, for tenths,
    hundredths and thousandths, as resistors of 1 % have it. None where it is none.
    """
    if re.fullmatch(r"0{1,4}", code):
        return 0.0
    if match := _WITH_POINT.fullmatch(code):
        if not (match[1] or match[3]) or (match[2] not in "RLN" and not match[1]):
            return None
        return float(f"{match[1] or '0'}.{match[3] or '0'}") * _POINTS[match[2]]
    if re.fullmatch(r"[0-9]{2,3}[JKL]", code) and tight:
        return int(code[:-1]) * 10.0 ** _BELOW[code[-1]]
    if not re.fullmatch(r"[0-9]{3,4}", code):
        return None
    power = _BELOW.get(code[-1], int(code[-1])) if tight or len(code) == 3 else int(code[-1])
    return int(code[:-1]) * 10.0**power


def preferred(number: int) -> bool:
    """Whether a number of three digits is a value that resistors are made in (IEC 60063, E24 and E96)."""
    while number and number % 10 == 0:
        number //= 10
    wanted = number * 10 ** (3 - len(str(number)))
    return wanted in {round(100 * 10 ** (k / 96)) for k in range(96)} | {10 * one for one in _E24}


_E24 = (10, 11, 12, 13, 15, 16, 18, 20, 22, 24, 27, 30, 33, 36, 39, 43, 47, 51, 56, 62, 68, 75, 82, 91)


def same(one: float, other: float) -> bool:
    """Whether two figures are of one value, as lists round them."""
    return math.isclose(one, other, rel_tol=0.011, abs_tol=1e-15)
