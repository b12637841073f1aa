"""NSWC-11 §8.5, splines:  λ = 10⁶/θ · C_GS · C_GL · C_GT · C_GV   failures/10⁶ revolutions, here by 60 rpm per hour

θ = 7.08·10⁻¹⁰ · (φ·G_L/G_D)^4.56 · A_E^−2.36 and φ = 4.85·10³ · G_B · G_D³/G_T in inches, inch-pounds, radians.
One transcription has it; that θ counts revolutions is read from it, and not confirmed.
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source
from robophm.hazard.handbooks.nswc_11 import INCH, ONCE, PER_HOUR, POUND, TITLE, product, size
from robophm.hazard.handbooks.nswc_11._gear import MISALIGNMENT, MOVING, SERVED, served, speed_factor
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=Source(TITLE, "8.5", "Eqs 8-10 … 8-13", f"{ONCE}; that θ counts revolutions is unconfirmed"),
    inputs={
        **MOVING,
        "hardness": Range(20.0, 800.0, "", "G_B, of the teeth, Brinell", monotone=-1),
        "diameter": Range(1.0, 2000.0, "mm", "G_D, of the spline", monotone=-1),
        "length": Range(1.0, 2000.0, "mm", "G_L, of the spline", monotone=-1),
        "torque": Range(1e-3, 1e7, "N*m", "G_T", monotone=1, stress="load"),
        "misalignment": MISALIGNMENT,
        **SERVED,
    },
)
def hazard_rate(
    speed: Array,
    design_speed: Array,
    hardness: Array,
    diameter: Array,
    length: Array,
    torque: Array,
    misalignment: Array,
    specified_viscosity: Array,
    lubricant_viscosity: Array,
    temperature: Array,
    prime_mover: str,
    driven_load: str,
) -> Factor:
    """λ = 60 rpm · 10⁶/θ · C_GS · C_GL · C_GT · C_GV"""
    inches = size(diameter) / INCH
    share = 4.85e3 * size(hardness) * inches**3 / (size(torque) * 1e3 / INCH / POUND)
    slope = size(length) / size(diameter)
    theta = 7.08e-10 * (share * slope) ** 4.56 * np.deg2rad(size(misalignment)) ** -2.36
    return product(
        (
            Factor("60 rpm", 60 * size(speed), "revolutions per hour"),
            Factor("10⁶/θ", 1e6 / theta, "failures/10⁶ revolutions"),
            speed_factor(speed, design_speed),
            *served(specified_viscosity, lubricant_viscosity, temperature, prime_mover, driven_load),
            PER_HOUR,
        )
    )
