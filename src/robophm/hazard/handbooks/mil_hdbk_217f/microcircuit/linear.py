"""MIL-HDBK-217F(2) §5.1, linear:  λp = (C1 · πT + C2 · πE) · πQ · πL   failures/10⁶ h

Bipolar and MOS alike, up to 10,000 transistors; 60,000 by ANSI/VITA 51.1.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    COMMON,
    EXTENDED,
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

DIE = Table("linear C1 by transistors, up to", SOURCE, """
    100    0.010
    300    0.020
    1000   0.040
    10000  0.060
""")  # fmt: skip

MORE = Table("linear C1 by transistors, up to, extended", VITA, """
    30000  0.080
    60000  0.100
""")  # fmt: skip

ACTIVATION_ENERGY = 0.65  # eV


@hazard_model(
    source=SOURCE,
    inputs={"transistors": Range(1, 60000, "", "transistors", whole=True, monotone=1), **COMMON},
)
def hazard_rate(
    transistors: Array,
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
    junction = junction_temperature(package, die, power, environment, case_temperature, thermal_resistance)
    return (
        (
            die_factor(DIE, MORE, transistors, "value", "linear by transistors")
            * temperature_factor(junction, ACTIVATION_ENERGY)
            + package_factor(package, pins) * environment_factor(environment)
        )
        * quality_factor(quality, screening_points)
        * learning_factor(years_in_production)
        * per_million_hours()
    )
