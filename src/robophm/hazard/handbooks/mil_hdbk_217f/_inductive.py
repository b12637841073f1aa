"""Common parts of transformers and coils, MIL-HDBK-217F Notice 2 §11: hot spot, πT and πE."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, handbook_arrhenius, span
from robophm.hazard.model import Array, Choice, Factor, Input, Range, more_than

HOT_SPOT = Source(TITLE, "11.3", "11-3 … 11-4", "one transcription; the range of case areas from another program")

SLASH_SHEET = Table("temperature rise ΔT of MIL-C-39010 coils", HOT_SPOT, """
    39010/1C   15
    39010/2C   15
    39010/3C   15
    39010/5C   15
    39010/7C   15
    39010/9A   15
    39010/10A  15
    39010/13   15
    39010/14   15
    39010/4C   35
    39010/6C   35
    39010/8A   35
    39010/11   35
    39010/12   35
""", columns=("ΔT",))  # fmt: skip

CASE = Table("radiating area of MIL-T-27 cases", HOT_SPOT, """
    T27/AF  4
    T27/AG  7
    T27/AH  11
    T27/AJ  18
    T27/EB  21
    T27/EA  23
    T27/FB  25
    T27/FA  31
    T27/GB  33
    T27/GA  43
    T27/HB  42
    T27/HA  53
    T27/JB  58
    T27/JA  71
    T27/KB  72
    T27/KA  84
    T27/LB  82
    T27/LA  98
    T27/MB  98
    T27/MA  115
    T27/NB  117
    T27/NA  139
    T27/OA  146
""", columns=("in²",))  # fmt: skip

NEEDS = {
    "stated": ("temperature_rise",),
    "case_area": ("power_loss", "case_area"),
    "weight": ("power_loss", "weight"),
    "input_power": ("input_power", "weight"),
    **dict.fromkeys(CASE, ("power_loss",)),
    **dict.fromkeys(SLASH_SHEET, ()),
}
"""The ways to a temperature rise, and the numbers that each needs."""

SHARED = Source(TITLE, "11", "11-2 … 11-3", "two transcriptions agree")

ENVIRONMENT = Table("inductive device environment πE", SHARED, """
    GB   1.0
    GF   6.0
    GM   12.0
    NS   5.0
    NU   16.0
    AIC  6.0
    AIF  8.0
    AUC  7.0
    AUF  9.0
    ARW  24.0
    SF   0.5
    MF   13.0
    ML   34.0
    CL   610.0
""")  # fmt: skip

HOTTEST = 190.0  # °C, where the printed table of πT ends
SQUARE_INCH = 6.4516  # cm²
POUND = 0.45359237  # kg


def hot_spot_inputs() -> Mapping[str, Input]:
    """The inputs from which the temperature of the hot spot follows, THS = TA + 1.1 · ΔT."""
    return {
        "temperature": Range(-55.0, HOTTEST, "degC", "ambient temperature", monotone=1, warmth="ambient"),
        "rise_from": Choice(
            tuple(NEEDS), "what gives the rise ΔT: as stated, a slash sheet or case by name, area, weight", "stated"
        ),
        "temperature_rise": Range(
            0.0,
            200.0,
            "K",
            "average rise ΔT above ambient, where stated; 0 K at the hot spot itself",
            required=False,
            monotone=1,
        ),
        "power_loss": Range(0.0, 1e4, "W", "power lost as heat", required=False),
        "case_area": Range(3 * SQUARE_INCH, 150 * SQUARE_INCH, "cm^2", "radiating area of the case", required=False),
        "weight": Range(1e-3, 1e3, "kg", "weight of the transformer", required=False),
        "input_power": Range(0.0, 1e5, "W", "input power, at an efficiency of 80 %", required=False),
    }


def temperature_factor(name: str, temperature: Array, rise_from: str, **given: Array | None) -> Factor:
    """πT of the hot spot; ``given`` are the other hot-spot inputs. Raises ModelError for one that is needed."""
    needed = [np.abs(value) for key in NEEDS[rise_from] if (value := given[key]) is not None]
    if len(needed) < len(NEEDS[rise_from]):
        wanted = " and ".join(f"'{key}'" for key in NEEDS[rise_from])
        raise ModelError(f"{name}: rise_from {rise_from} needs {wanted}; other ways: {', '.join(list(NEEDS)[1:5])} …")
    if rise_from in SLASH_SHEET:
        rise = np.asarray(SLASH_SHEET[rise_from])
    elif rise_from in CASE:
        rise = 125 * needed[0] / CASE[rise_from]
    elif rise_from == "case_area":
        rise = 125 * needed[0] / (needed[1] / SQUARE_INCH)
    elif rise_from == "stated":
        rise = needed[0]
    else:
        rise = (2.1 if rise_from == "input_power" else 11.5) * needed[0] / (needed[1] / POUND) ** 0.6766
    hot_spot = np.asarray(temperature) + 1.1 * rise
    return Factor(
        "πT",
        handbook_arrhenius(hot_spot, 0.11),
        f"Ea = 0.11 eV, hot spot at {span(hot_spot)} °C (up to {HOTTEST:g}), ΔT = {span(rise)} K from {rise_from}",
        outside=above(hot_spot, HOTTEST),
        beyond=more_than("the temperature of the hot spot", hot_spot, "the handbook's", HOTTEST, "°C"),
    )
