"""MIL-HDBK-217F(2) §5.1, gate and logic arrays, digital:  λp = (C1 · πT + C2 · πE) · πQ · πL   failures/10⁶ h

Up to 60,000 gates; CMOS above is §5.3.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours, steps
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    COMMON,
    FAMILIES,
    FAMILY,
    STATUS,
    environment_factor,
    junction_temperature,
    learning_factor,
    package_factor,
    quality_factor,
    temperature_factor,
)
from robophm.hazard.model import Array, Factor, Range, hazard_model

SOURCE = Source(TITLE, "5.1", "–", f"{STATUS}; C1 three; checked against Appendix A")

DIE = Table("digital C1 by gates, up to", SOURCE, """
    100    0.0025  0.010
    1000   0.0050  0.020
    3000   0.010   0.040
    10000  0.020   0.080
    30000  0.040   0.16
    60000  0.080   0.29
""", columns=("bipolar", "MOS"))  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={"family": FAMILIES, "gates": Range(1, 60000, "", "logic gates", whole=True, monotone=1), **COMMON},
)
def hazard_rate(
    family: str,
    gates: Array,
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
            Factor("C1", steps(DIE, gates, column), f"{column} logic by gates")
            * temperature_factor(junction, FAMILY[family])
            + package_factor(package, pins) * environment_factor(environment)
        )
        * quality_factor(quality, screening_points)
        * learning_factor(years_in_production)
        * per_million_hours()
    )
