"""MIL-HDBK-217F(2) §6.3, bipolar transistors below 200 MHz:  λp = λb · πT · πA · πR · πS · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import STEEPEST, closing, stress_ratio
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    ENVIRONMENT,
    QUALITY,
    junction_inputs,
    quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(TITLE, "6.3", "6-6 … 6-7", "two transcriptions agree; checked against Appendix A and a worked example")

APPLICATION = Table("bipolar transistor application πA", SOURCE, """
    linear     1.5  linear amplification
    switching  0.7  switching
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "application": Choice(APPLICATION, "application", aliases={"amplifier": "linear", "switch": "switching"}),
        **junction_inputs(),
        "rated_power": Range(1e-3, 1e3, "W", "rated power"),
        "voltage": Range(0.0, 1e5, "V", "collector to emitter VCE, applied", monotone=1),
        "rated_voltage": Range(1e-3, 1e5, "V", "rated VCEO, base open", monotone=-1),
        "quality": quality(),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    application: str,
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
    """λp = λb · πT · πA · πR · πS · πQ · πE

    πR is 0.43 up to 0.1 W and P^0.37 above; πS = 0.045 · exp(3.1 · S). A dual transistor is the sum of its sides.
    Quality is plastic, the worst, unless stated.
    """
    return (
        Factor("λb", 0.00074, "NPN and PNP, failures/10⁶ h")
        * temperature_factor(2114, temperature, power, package, thermal_resistance)
        * Factor("πA", APPLICATION[application], APPLICATION.notes[application])
        * power_rating(rated_power)
        * voltage_stress(voltage, rated_voltage)
        * closing(QUALITY, quality, ENVIRONMENT, environment)
    )


def power_rating(rated_power: Array) -> Factor:
    """πR of a bipolar transistor, also of one of low noise (§6.6)."""
    watts = np.abs(rated_power)
    return Factor("πR", np.where(above(watts, 0.1), watts**0.37, 0.43), f"{span(watts)} W rated power")


def voltage_stress(voltage: Array, rated_voltage: Array) -> Factor:
    """πS of a bipolar transistor, also of one of low noise (§6.6)."""
    stress = stress_ratio(voltage, rated_voltage)
    return Factor(
        "πS",
        0.045 * np.exp(3.1 * np.minimum(stress, STEEPEST)),
        f"voltage stress S = VCE/VCEO = {span(stress)} of at most 1",
        outside=above(stress, 1.0),
        beyond=more_than("the applied voltage", np.abs(voltage), "the rated voltage", rated_voltage, "V"),
    )
