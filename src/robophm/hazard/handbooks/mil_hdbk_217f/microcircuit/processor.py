"""MIL-HDBK-217F(2) §5.1, microprocessors, microcontrollers:  λp = (C1 · πT + C2 · πE) · πQ · πL   failures/10⁶ h

Up to 32 bits; 64 and 128 by ANSI/VITA 51.1. A microcontroller counts by its word: an STM32F407 is CMOS of 32 bits.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    COMMON,
    EXTENDED,
    FAMILIES,
    FAMILY,
    STATUS,
    VITA,
    die_factor,
    environment_factor,
    junction_temperature,
    learning_factor,
    package_factor,
    quality_factor,
    temperature_factor,
)
from robophm.hazard.model import Array, Factor, Range, hazard_model

SOURCE = Source(TITLE, "5.1", "–", f"{STATUS}; C1 three; {EXTENDED}; checked against Appendix A")

DIE = Table("microprocessor C1 by bits, up to", SOURCE, """
    8   0.060  0.14
    16  0.12   0.28
    32  0.24   0.56
""", columns=("bipolar", "MOS"))  # fmt: skip

MORE = Table("microprocessor C1 by bits, up to, extended", VITA, """
    64   0.48  1.12
    128  0.96  2.24
""", columns=("bipolar", "MOS"))  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={"family": FAMILIES, "bits": Range(1, 128, "bit", "width of a word", whole=True, monotone=1), **COMMON},
)
def hazard_rate(
    family: str,
    bits: Array,
    package: str,
    die: str,
    pins: Array,
    power: Array,
    years_in_production: Array,
    quality: str,
    environment: str,
    case_temperature: Array | None = None,
    thermal_resistance: Array | None = None,
    screening_points: Array | None = None,
) -> Factor:
    """λp = (C1 · πT + C2 · πE) · πQ · πL"""
    column = "MOS" if FAMILY.cell(family, "MOS") else "bipolar"
    junction = junction_temperature(package, die, power, environment, case_temperature, thermal_resistance)
    return (
        (
            die_factor(DIE, MORE, bits, column, f"{column} by bits of a word")
            * temperature_factor(junction, FAMILY[family])
            + package_factor(package, pins) * environment_factor(environment)
        )
        * quality_factor(quality, screening_points)
        * learning_factor(years_in_production)
        * per_million_hours()
    )
