"""MIL-HDBK-217F(2) §5.3, VHSIC and VLSI CMOS:  λp = λBD · πMFG · πT · πCD + λBP · πE · πQ · πPT + λEOS

failures/10⁶ h, for CMOS above 60,000 gates. There is no learning factor. A die of today's feature
sizes is far outside of what the handbook printed. One transcription, hardly checked.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    CASE,
    ENVIRONMENTS,
    LIMITS,
    PACKAGE,
    PINS,
    POWER,
    QUALITIES,
    RESISTANCE,
    SCREENING,
    environment_factor,
    junction_temperature,
    quality_factor,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "5.3",
    "–",
    "single transcription but for λEOS, which a second program shares; no published answer; "
    f"that the section ends at 0.8 … 2 µm and 3 cm² is from memory, as are the {LIMITS.removesuffix(' from memory')}",
)

STYLE = Table("VHSIC λBD", SOURCE, """
    logic   0.16  logic and custom
    array   0.24  gate array
    memory  0.24
""")  # fmt: skip

MANUFACTURE = Table("VHSIC πMFG", SOURCE, """
    QML    0.55  QML or QPL
    other  2.0
""")  # fmt: skip

PACKAGE_TYPE = Table("VHSIC πPT", SOURCE, """
    DIP-hermetic  1.0
    DIP-plastic   1.3
    PGA-hermetic  2.2
    PGA-plastic   2.9
    SMT-hermetic  4.7  chip carrier
    SMT-plastic   6.1  chip carrier
""")  # fmt: skip

ACTIVATION_ENERGY = 0.35  # eV
LARGE_DIE = 14_400 * 2.54e-3**2  # cm², where θJC changes


def _resistance(given: Mapping[str, Any]) -> tuple[float, str]:
    package, die = given["package"], "large" if above(given["die_area"], LARGE_DIE) else "small"
    return PACKAGE.cell(package, f"{die} die"), f"the handbook's for {package} with a {die} die"


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(STYLE, "kind of circuit", aliases={"custom": "logic", "gate array": "array"}),
        "manufacture": Choice(MANUFACTURE, "manufacturing process", default="other", aliases={"qpl": "QML"}),
        "die_area": Range(1e-3, 3.0, "cm^2", "area of the die", monotone=0),
        "feature_size": Range(0.8, 2.0, "um", "feature size", monotone=-1),
        "package": Choice(PACKAGE_TYPE, "package and seal"),
        "pins": PINS,
        "power": POWER,
        "case_temperature": CASE,
        "thermal_resistance": replace(RESISTANCE, otherwise=_resistance),
        "discharge_threshold": Range(
            0.0,
            16e3,
            "V",
            "electrostatic discharge that it withstands, human body model; 0 V stands for the class of 0–1000 V",
            default=0.0,
            monotone=-1,
        ),
        "quality": QUALITIES,
        "screening_points": SCREENING,
        "environment": ENVIRONMENTS,
    },
)
def hazard_rate(
    style: str,
    manufacture: str,
    die_area: Array,
    feature_size: Array,
    package: str,
    pins: Array,
    power: Array,
    discharge_threshold: Array,
    quality: str,
    environment: str,
    case_temperature: Array | None = None,
    thermal_resistance: Array | None = None,
    screening_points: Array | None = None,
) -> Factor:
    """λp = λBD · πMFG · πT · πCD + λBP · πE · πQ · πPT + λEOS"""
    if thermal_resistance is None:
        large, small = PACKAGE.cell(package, "large die"), PACKAGE.cell(package, "small die")
        thermal_resistance = np.where(above(die_area, LARGE_DIE), large, small)
    junction = junction_temperature(package, "small", power, environment, case_temperature, thermal_resistance)
    complexity = np.asarray(die_area) / 0.21 * (2 / np.asarray(feature_size)) ** 2 * 0.64 + 0.36
    discharge = -np.log(1 - 0.00057 * np.exp(-0.0002 * np.maximum(discharge_threshold, 0.0))) / 0.00876
    return (
        Factor("λBD", STYLE[style], f"{style}, failures/10⁶ h")
        * Factor("πMFG", MANUFACTURE[manufacture], f"{manufacture} process")
        * temperature_factor(junction, ACTIVATION_ENERGY)
        * Factor("πCD", complexity, "(A/0.21) (2/Xs)² 0.64 + 0.36, A in cm², Xs in µm")
        + Factor("λBP", 0.0022 + 1.72e-5 * np.asarray(pins), "by pins, failures/10⁶ h")
        * environment_factor(environment)
        * quality_factor(quality, screening_points)
        * Factor("πPT", PACKAGE_TYPE[package], package)
        + Factor("λEOS", discharge, "electrical overstress, by the discharge threshold, failures/10⁶ h")
    ) * per_million_hours()
