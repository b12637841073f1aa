"""MIL-HDBK-217F(2) §5.4, GaAs MMIC and digital devices:  λp = (C1 · πT · πA + C2 · πE) · πQ · πL   failures/10⁶ h

MMIC up to 1,000 elements, digital up to 10,000. πT is 0.1 at 423 K.
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours, steps
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    COMMON,
    STATUS,
    environment_factor,
    junction_temperature,
    learning_factor,
    package_factor,
    quality_factor,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "5.4",
    "–",
    f"{STATUS}; MMIC checked against a worked example; Appendix A contradicts it: its generic rates are higher, up to "
    "several times, and rise less with temperature than 1.4 or 1.5 eV make them",
)

MMIC = Table("GaAs MMIC C1 by elements, up to", SOURCE, """
    100   4.5
    1000  7.2
""")  # fmt: skip

DIGITAL = Table("GaAs digital C1 by elements, up to", SOURCE, """
    1000   25
    10000  51
""")  # fmt: skip

APPLICATION = Table("GaAs πA and activation energy", SOURCE, """
    MMIC-low-power  1  1.5  low noise and low power, up to 100 mW
    MMIC            3  1.5  driver and high power, above 100 mW, or unknown
    digital         1  1.4
""", columns=("πA", "Ea"))  # fmt: skip

REFERENCE = 423.0  # K


@hazard_model(
    source=SOURCE,
    inputs={
        "application": Choice(APPLICATION, "kind, and power of an MMIC", aliases={"unknown": "MMIC"}),
        "elements": Range(1, 10000, "", "active elements, at most 1000 of an MMIC", whole=True, monotone=1),
        **COMMON,
    },
)
def hazard_rate(
    application: str,
    elements: Array,
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
    """λp = (C1 · πT · πA + C2 · πE) · πQ · πL"""
    table, limit = (DIGITAL, 10000) if application == "digital" else (MMIC, 1000)
    junction = junction_temperature(package, die, power, environment, case_temperature, thermal_resistance)
    return (
        (
            Factor(
                "C1",
                steps(table, elements),
                f"{application} by elements, at most {limit}",
                outside=above(elements, limit),
                beyond=lambda: (
                    f"{np.max(elements):.6g} elements are more than the {limit} that the handbook has of {application}"
                ),
            )
            * temperature_factor(junction, APPLICATION.cell(application, "Ea"), REFERENCE)
            * Factor("πA", APPLICATION[application], f"{application} {APPLICATION.notes[application]}".rstrip())
            + package_factor(package, pins) * environment_factor(environment)
        )
        * quality_factor(quality, screening_points)
        * learning_factor(years_in_production)
        * per_million_hours()
    )
