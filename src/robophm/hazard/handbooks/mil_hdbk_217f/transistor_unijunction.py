"""MIL-HDBK-217F(2) §6.5, unijunction transistors:  λp = λb · πT · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

from robophm.core.table import Source
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    ENVIRONMENT,
    QUALITY,
    junction_inputs,
    quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Factor, hazard_model


@hazard_model(
    source=Source(TITLE, "6.5", "6-9", "two transcriptions agree; checked against Appendix A as one program has it"),
    inputs={
        **junction_inputs(),
        "quality": quality(),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    temperature: Array,
    power: Array,
    package: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πQ · πE

    Quality is plastic, the worst, unless stated.
    """
    return (
        Factor("λb", 0.0083, "all unijunction transistors, failures/10⁶ h")
        * temperature_factor(2483, temperature, power, package, thermal_resistance)
        * closing(QUALITY, quality, ENVIRONMENT, environment)
    )
