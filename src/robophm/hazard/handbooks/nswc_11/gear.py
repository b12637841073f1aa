"""NSWC-11 §8 Eq 8-2, gears:  λ = λG,B · C_GS · C_GP · C_GA · C_GL · C_GT · C_GV   failures/10⁶ h, of one gear

At design speed and load C_GS is 2 and C_GP 25.8, as printed.
"""

from __future__ import annotations

import numpy as np

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product, size
from robophm.hazard.handbooks.nswc_11._gear import MISALIGNMENT, MOVING, SERVED, SOURCE, served, speed_factor
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=SOURCE,
    inputs={
        **MOVING,
        "load": Range(0.0, 1e9, "N*m", "L_O, as operated", monotone=1),
        "design_load": Range(1e-6, 1e9, "N*m", "L_D, as designed for", monotone=-1),
        "misalignment": MISALIGNMENT,
        **SERVED,
        "design_life": Range(1e3, 1e14, "revolution", "revolutions it is designed for", default=1e8, monotone=-1),
    },
)
def hazard_rate(
    speed: Array,
    design_speed: Array,
    load: Array,
    design_load: Array,
    misalignment: Array,
    specified_viscosity: Array,
    lubricant_viscosity: Array,
    temperature: Array,
    prime_mover: str,
    driven_load: str,
    design_life: Array,
) -> Factor:
    """λ = λG,B · C_GS · C_GP · C_GA · C_GL · C_GT · C_GV"""
    return product(
        (
            Factor("λG,B", 1e6 * 60 * size(speed) / size(design_life), "60 rpm/design life, failures/10⁶ h"),
            speed_factor(speed, design_speed),
            Factor("C_GP", (size(load) / size(design_load) / 0.5) ** 4.69, "((L_O/L_D)/0.5)^4.69"),
            Factor("C_GA", (np.deg2rad(size(misalignment)) / 0.006) ** 2.36, "(A_E/0.006 rad)^2.36"),
            *served(specified_viscosity, lubricant_viscosity, temperature, prime_mover, driven_load),
            PER_HOUR,
        )
    )
