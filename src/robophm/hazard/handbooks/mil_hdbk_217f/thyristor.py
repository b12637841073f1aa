"""MIL-HDBK-217F(2) §6.10, thyristors and silicon-controlled rectifiers:

λp = λb · πT · πR · πS · πQ · πE   failures/10⁶ h
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing, stress_ratio
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    ENVIRONMENT,
    QUALITY,
    junction_inputs,
    quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Factor, Range, hazard_model, more_than


@hazard_model(
    source=Source(TITLE, "6.10", "6-17", "two transcriptions agree; checked against Appendix A as one program has it"),
    inputs={
        **junction_inputs(),
        "rated_current": Range(1e-3, 1e4, "A", "rated forward current, rms", monotone=1),
        "voltage": Range(0.0, 1e5, "V", "blocking voltage, applied", monotone=1),
        "rated_voltage": Range(1e-3, 1e5, "V", "rated blocking voltage", monotone=-1),
        "quality": quality(),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    temperature: Array,
    power: Array,
    package: str,
    rated_current: Array,
    voltage: Array,
    rated_voltage: Array,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πR · πS · πQ · πE

    πR = I^0.40; πS is 0.1 up to S = 0.3 and S^1.9 above. Quality is plastic, the worst, unless stated.
    """
    stress = stress_ratio(voltage, rated_voltage)
    amperes = np.abs(rated_current)
    return (
        Factor("λb", 0.0022, "all thyristors, failures/10⁶ h")
        * temperature_factor(3082, temperature, power, package, thermal_resistance)
        * Factor("πR", amperes**0.40, f"{span(amperes)} A rated current")
        * Factor(
            "πS",
            np.where(above(stress, 0.3), stress**1.9, 0.1),
            f"blocking voltage stress S = {span(stress)} of at most 1",
            outside=above(stress, 1.0),
            beyond=more_than("the applied voltage", np.abs(voltage), "the rated voltage", rated_voltage, "V"),
        )
        * closing(QUALITY, quality, ENVIRONMENT, environment)
    )
