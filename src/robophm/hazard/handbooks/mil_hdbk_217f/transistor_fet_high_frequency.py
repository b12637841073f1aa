"""MIL-HDBK-217F(2) §6.9, silicon field-effect transistors above 400 MHz, below 0.3 W:

λp = λb · πT · πQ · πE   failures/10⁶ h
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    RF_ENVIRONMENT,
    RF_QUALITY,
    junction_inputs,
    rf_quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, hazard_model

SOURCE = Source(
    TITLE,
    "6.9",
    "6-16",
    "two transcriptions agree on λb, B and πQ; πE is one's, the other has that of low frequency; no published answer",
)

KIND = Table("high-frequency silicon field-effect transistor type λb", SOURCE, """
    MOSFET  0.060
    JFET    0.023
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "MOSFET or junction FET"),
        **junction_inputs(),
        "quality": rf_quality(),
        "environment": environment_choice(RF_ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    power: Array,
    package: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πQ · πE

    πE is unresolved: that of all high-frequency transistors here; another program takes that of low frequency.
    Quality is the handbook's lower unless stated.
    """
    return (
        Factor("λb", KIND[kind], f"{kind}, failures/10⁶ h")
        * temperature_factor(1925, temperature, power, package, thermal_resistance)
        * closing(RF_QUALITY, quality, RF_ENVIRONMENT, environment)
    )
