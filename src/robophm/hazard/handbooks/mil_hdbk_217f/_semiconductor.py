"""Common parts of discrete semiconductors, MIL-HDBK-217F Notice 2 §6: junction temperature, πT, πQ and πE."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from robophm.core.table import Source, Table, above, below
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.model import Array, Choice, Factor, Input, Range, more_than

THERMAL = Source(TITLE, "6.14", "6-23", "two transcriptions agree on the table; the page is by order, not seen")

PACKAGE = Table("thermal resistance θJC, junction to case", THERMAL, """
    TO-1      70
    TO-3      10
    TO-5      70
    TO-8      70
    TO-9      70
    TO-12     70
    TO-18     70
    TO-28     5
    TO-33     70
    TO-39     70
    TO-41     10
    TO-44     70
    TO-46     70
    TO-52     70
    TO-53     5
    TO-57     5
    TO-59     5
    TO-60     5
    TO-61     5
    TO-63     5
    TO-66     10
    TO-71     70
    TO-72     70
    TO-83     5
    TO-89     22
    TO-92     70
    TO-94     5
    TO-99     70
    TO-126    5
    TO-127    5
    TO-204    10
    TO-204AA  10
    TO-205AD  70
    TO-205AF  70
    TO-220    5
    DO-4      5
    DO-5      5
    DO-7      10
    DO-8      5
    DO-9      5
    DO-13     10
    DO-14     5
    DO-29     10
    DO-35     10
    DO-41     10
    DO-45     5
    DO-204MB  70
    DO-205AB  5
    PA-42A    70
    PA-42B    70
    PD-36C    70
    PD-50     70
    PD-77     70
    PD-180    70
    PD-319    70
    PD-262    70
    PD-975    70
    PD-280    70
    PD-216    70
    PT-2G     70
    PT-6B     70
    PH-13     70
    PH-16     70
    PH-56     70
    PY-58     70
    PY-373    70
    unknown   70  no row of the handbook: the largest of its table
""")  # fmt: skip

SHARED = Source(TITLE, "6", "6-2 … 6-22", "two transcriptions agree")

QUALITY = Table("semiconductor quality πQ", SHARED, """
    JANTXV   0.7
    JANTX    1.0
    JAN      2.4
    lower    5.5  hermetic, below JAN
    plastic  8.0  encapsulated or sealed with organic material
""")  # fmt: skip

RF_QUALITY = Table("high-frequency transistor quality πQ", SHARED, """
    JANTXV  0.5
    JANTX   1.0
    JAN     2.0
    lower   5.0
""")  # fmt: skip

ENVIRONMENT = Table("semiconductor environment πE", SHARED, """
    GB   1.0
    GF   6.0
    GM   9.0
    NS   9.0
    NU   19.0
    AIC  13.0
    AIF  29.0
    AUC  20.0
    AUF  43.0
    ARW  24.0
    SF   0.5
    MF   14.0
    ML   32.0
    CL   320.0
""")  # fmt: skip

RF_ENVIRONMENT = Table("high-frequency semiconductor environment πE", SHARED, """
    GB   1.0
    GF   2.0
    GM   5.0
    NS   4.0
    NU   11.0
    AIC  4.0
    AIF  5.0
    AUC  7.0
    AUF  12.0
    ARW  16.0
    SF   0.5
    MF   9.0
    ML   24.0
    CL   250.0
""")  # fmt: skip

OPTICAL_ENVIRONMENT = Table("optoelectronic environment πE", SHARED, """
    GB   1.0
    GF   2.0
    GM   8.0
    NS   5.0
    NU   12.0
    AIC  4.0
    AIF  6.0
    AUC  6.0
    AUF  8.0
    ARW  17.0
    SF   0.5
    MF   9.0
    ML   24.0
    CL   450.0
""")  # fmt: skip

COMMERCIAL_IS_PLASTIC = {"commercial": "plastic"}
COMMERCIAL_IS_LOWER = {"commercial": "lower"}

HOTTEST = 175.0
"""Upper end of the printed tables of πT [°C]. They begin at 25 °C; below it the equation holds."""


def quality() -> Choice:
    """The input of the five levels; plastic, the worst of them and what most robots have, unless stated."""
    return Choice(QUALITY, "quality level", default="plastic", aliases=COMMERCIAL_IS_PLASTIC)


def rf_quality() -> Choice:
    """The input of the four levels of high-frequency transistors; the handbook's lower unless stated."""
    return Choice(RF_QUALITY, "quality level", default="lower", aliases=COMMERCIAL_IS_LOWER)


def junction_inputs(hottest: float = HOTTEST) -> Mapping[str, Input]:
    """The inputs from which the temperature of a junction follows, TJ = TC + θJC · P."""
    return {
        "temperature": Range(-55.0, hottest, "degC", "case temperature", monotone=1, warmth="own"),
        "power": Range(
            0.0, 1e4, "W", "power dissipated; 0 W where the temperature is already the junction's", monotone=1
        ),
        "package": Choice(
            PACKAGE,
            "package, which gives the thermal resistance unless that is stated",
            default="unknown",
            aliases={key.replace("-", ""): key for key in PACKAGE if "-" in key},
        ),
        "thermal_resistance": Range(
            0.0, 1e3, "K/W", "junction to case, by its maker", required=False, otherwise=_resistance, monotone=1
        ),
    }


def _resistance(given: Mapping[str, Any]) -> tuple[float, str]:
    package = given["package"]
    return PACKAGE[package], "the largest of the table" if package == "unknown" else f"the table's, of a {package}"


def temperature_factor(
    coefficient: float,
    temperature: Array,
    power: Array,
    package: str,
    thermal_resistance: Array | None,
    *,
    scale: Array | float = 1.0,
    reference: float = 298.0,
    coolest: float = -55.0,
    hottest: float = HOTTEST,
) -> Factor:
    """πT = scale · exp(−B · (1/(TJ + 273) − 1/reference)), outside where TJ is not of ``coolest`` … ``hottest`` °C."""
    given = thermal_resistance is not None
    resistance = np.asarray(thermal_resistance if given else PACKAGE[package])
    junction = np.asarray(temperature) + resistance * np.abs(power)
    kelvin = np.maximum(junction + 273, 1.0)  # what a broken sensor says: no pole at 0 K
    too_cold = bool(np.any(below(junction, coolest)))
    origin = "as stated" if given else "of the table's largest" if package == "unknown" else package
    return Factor(
        "πT",
        scale * np.exp(-coefficient * (1 / kelvin - 1 / reference)),
        f"B = {coefficient:g} K, TJ = {span(junction)} °C (of {coolest:g} … {hottest:g}), "
        f"θJC = {span(resistance)} K/W, {origin}",
        outside=below(junction, coolest) | above(junction, hottest),
        beyond=(
            (lambda: f"the junction, at {np.min(junction):.6g} °C, is colder than the handbook's {coolest:g} °C")
            if too_cold
            else more_than("the temperature of the junction", junction, "the handbook's", hottest, "°C")
        ),
    )
