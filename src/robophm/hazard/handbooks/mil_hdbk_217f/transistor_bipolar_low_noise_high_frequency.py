"""MIL-HDBK-217F(2) §6.6, low-noise bipolar transistors above 200 MHz, below 1 W:

λp = λb · πT · πR · πS · πQ · πE   failures/10⁶ h
"""

from __future__ import annotations

from robophm.core.table import Source
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
from robophm.hazard.handbooks.mil_hdbk_217f.transistor_bipolar_low_frequency import power_rating, voltage_stress
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=Source(
        TITLE, "6.6", "6-10 … 6-11", "two transcriptions agree; checked against Appendix A as one program has it"
    ),
    inputs={
        **junction_inputs(),
        "rated_power": Range(1e-3, 1.0, "W", "rated power"),
        "voltage": Range(0.0, 1e4, "V", "collector to emitter VCE, applied", monotone=1),
        "rated_voltage": Range(1e-3, 1e4, "V", "rated VCEO, base open", monotone=-1),
        "quality": rf_quality(),
        "environment": environment_choice(RF_ENVIRONMENT),
    },
)
def hazard_rate(
    temperature: Array,
    power: Array,
    package: str,
    rated_power: Array,
    voltage: Array,
    rated_voltage: Array,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πR · πS · πQ · πE

    Quality is the handbook's lower unless stated.
    """
    return (
        Factor("λb", 0.18, "all low-noise high-frequency bipolar transistors, failures/10⁶ h")
        * temperature_factor(2114, temperature, power, package, thermal_resistance)
        * power_rating(rated_power)
        * voltage_stress(voltage, rated_voltage)
        * closing(RF_QUALITY, quality, RF_ENVIRONMENT, environment)
    )
