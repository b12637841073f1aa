"""MIL-HDBK-217F(2) §5.1, programmable logic arrays (PLA, PAL):  λp = (C1 · πT + C2 · πE) · πQ · πL   failures/10⁶ h

Up to 5,000 gates bipolar, 20,000 MOS; 60,000 of both by ANSI/VITA 51.1, which ends there: most FPGAs have more.
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

BIPOLAR = Table("bipolar PLA C1 by gates, up to", SOURCE, """
    200   0.010
    1000  0.021
    5000  0.042
""")  # fmt: skip

MOS = Table("MOS PLA C1 by gates, up to", SOURCE, """
    500    0.00085
    1000   0.0017
    5000   0.0034
    20000  0.0068
""")  # fmt: skip

MORE_BIPOLAR = Table("bipolar PLA C1 by gates, up to, extended", VITA, """
    10000  0.084
    30000  0.168
    60000  0.336
""")  # fmt: skip

MORE_MOS = Table("MOS PLA C1 by gates, up to, extended", VITA, """
    30000  0.0136
    60000  0.0272
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "family": FAMILIES,
        "gates": Range(1, 60000, "", "gates", whole=True, monotone=1),
        **COMMON,
    },
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
    name, tables = ("MOS", (MOS, MORE_MOS)) if FAMILY.cell(family, "MOS") else ("bipolar", (BIPOLAR, MORE_BIPOLAR))
    junction = junction_temperature(package, die, power, environment, case_temperature, thermal_resistance)
    return (
        (
            die_factor(*tables, gates, "value", f"{name} array by gates") * temperature_factor(junction, FAMILY[family])
            + package_factor(package, pins) * environment_factor(environment)
        )
        * quality_factor(quality, screening_points)
        * learning_factor(years_in_production)
        * per_million_hours()
    )
