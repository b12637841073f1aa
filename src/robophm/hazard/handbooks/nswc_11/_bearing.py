"""Common parts of both ways to a rolling bearing's rate, NSWC-11 chapter 7."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.handbooks.nswc_11 import TITLE, TWICE, size, viscosity
from robophm.hazard.model import Array, Choice, Factor, Input, Range

SOURCE = Source(TITLE, "7", "Eqs 7-4, 7-5, Tables 7-2 … 7-4, Figs 7.4, 7.5", TWICE)

EXPONENT = {"ball": 3.0, "roller": 3.3}

SERVICE = Table("bearing service C_SF", SOURCE, """
    uniform_steady      1.0  1.0
    light_shock         1.5  1.0
    moderate_shock      2.0  1.3
    heavy_shock         2.5  1.7
    extreme_shock       3.0  2.0
    precision_gearing   1.2  1.2  printed of ball bearings, taken for both
    commercial_gearing  1.3  1.3  printed of ball bearings, taken for both
    toothed_belts       1.2  1.2  printed of roller bearings, taken for both
    vee_belts           1.8  1.8  printed of roller bearings, taken for both
    flat_belts          3.0  3.0  printed of roller bearings, taken for both
""", columns=("ball", "roller"))  # fmt: skip

CLEANLINESS = Table("bearing contamination C_C", SOURCE, """
    extreme_clean           1.0  1.0
    high_clean              1.4  1.2  filter of at most 10 µm
    normal                  1.8  1.4
    slight_contamination    2.5  2.0  filter above 10 µm
    severe_contamination    5.0  3.3  no seals
""", columns=("d ≤ 100 mm", "d > 100 mm"))  # fmt: skip

KIND = Choice(tuple(EXPONENT), "rolling elements")
LOADS: Mapping[str, Input] = {
    "load": Range(0.0, 1e8, "N", "L_A, equivalent radial load as operated", monotone=1),
}
AROUND: Mapping[str, Input] = {
    "service": Choice(SERVICE, "how the load comes"),
    "cleanliness": Choice(CLEANLINESS, "of the lubricant"),
    "bore": Range(0.5, 2000.0, "mm", "d, diameter of the bore", monotone=-1),
    "specified_viscosity": Range(0.1, 1e6, "mm^2/s", "ν_O, of the lubricant that is specified", monotone=1),
    "lubricant_viscosity": Range(0.1, 1e6, "mm^2/s", "ν_L, of the lubricant that is used", monotone=-1),
    "water": Range(0.0, 5.0, "percent", "in the lubricant", monotone=0),
    "temperature": Range(-60.0, 400.0, "degC", "of operation", monotone=1, warmth="own"),
    "reliability": Range(
        50.0,
        99.0,
        "percent",
        "share that survives the life; 50 is the handbook's for an MTBF",
        default=50.0,
        monotone=1,
    ),
}


def around(
    kind: str,
    service: str,
    cleanliness: str,
    bore: Array,
    specified_viscosity: Array,
    lubricant_viscosity: Array,
    water: Array,
    temperature: Array,
    reliability: Array,
) -> tuple[Factor, ...]:
    """C_R · C_ν · C_CW · C_t · C_SF · C_C."""
    wet = np.clip(water, 0.0, 0.8)
    small, large = (CLEANLINESS.cell(cleanliness, column) for column in CLEANLINESS.columns)
    surviving = np.clip(reliability, 1e-3, 99.999)  # the logarithm's poles
    return (
        Factor(
            "C_R",
            0.223 / np.log(100 / surviving) ** (2 / 3),
            f"R = {_span(reliability)} %; 90 % counts 3.5 times as much as 50 %, which suits an MTBF",
        ),
        viscosity("C_ν", specified_viscosity, lubricant_viscosity),
        Factor("C_CW", 1 + 25.5 * wet - 16.25 * wet**2, "1 + 25.5 CW − 16.25 CW² up to 0.8 % of water, 11.0 above"),
        Factor("C_t", (np.maximum(temperature, 183) / 183) ** 3, "1 below 183 °C, (T/183)³ above"),
        Factor("C_SF", SERVICE.cell(service, kind), service),
        Factor("C_C", np.where(above(bore, 100.0), large, small), f"{cleanliness}, bore up to or above 100 mm"),
    )


def load_factor(kind: str, over: Array, under: Array) -> Array:
    """The load's part of a bearing's life: (over/under)^y."""
    result: Array = (size(over) / size(under)) ** EXPONENT[kind]
    return result


def _span(values: Array) -> str:
    low, high = np.min(values), np.max(values)
    return f"{low:g}" if low == high else f"{low:g} … {high:g}"
