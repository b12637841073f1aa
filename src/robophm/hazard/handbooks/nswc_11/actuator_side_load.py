"""NSWC-11 §9, hydraulic and pneumatic actuators under side load:  λ = 10⁶/N_O · C_CP · C_T   failures/10⁶ cycles

N_O = 15.4e3 · (γ·F_Y/((W_S/L) · ((D1 − D2)/(D1·D2))/K)^(1/2))⁹ cycles, C_CP = C_H · C_S · C_N.
k1 = 15.4·10³ follows from contact mechanics within 2 %.
Seals are another part of the design. An electric actuator is a motor, a gear, bearings and a screw.
"""

from __future__ import annotations

import numpy as np

from robophm.hazard.handbooks.nswc_11 import INCH, POUND, size
from robophm.hazard.handbooks.nswc_11._actuator import AROUND, GEOMETRY, SIDE, compliance, gap, wearing
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=SIDE,
    unit="1/cycle",
    inputs={
        "load": Range(0.0, 1e8, "N", "W_S, across the axis", monotone=1),
        "contact_length": Range(0.1, 3000.0, "mm", "L, over which piston and cylinder touch", monotone=-1),
        **GEOMETRY,
        **AROUND,
    },
)
def hazard_rate(
    load: Array,
    contact_length: Array,
    bore: Array,
    piston_diameter: Array,
    cylinder_modulus: Array,
    cylinder_poisson: Array,
    piston_modulus: Array,
    piston_poisson: Array,
    wear: str,
    material: str,
    particle_hardness: Array,
    cylinder_hardness: Array,
    filter_size: Array,
    particles: str,
    temperature: Array,
    yield_strength: Array | None = None,
) -> Factor:
    """λ = 10⁶/N_O · C_H · C_S · C_N · C_T"""
    curvature, outside = gap(bore, piston_diameter)
    soft = compliance(cylinder_modulus, cylinder_poisson, piston_modulus, piston_poisson)
    stress = np.sqrt(size(load) / POUND / (size(contact_length) / INCH) * curvature / soft)  # psi, short of a constant
    return wearing(
        15.4e3, stress, outside, wear, material, yield_strength, particle_hardness, cylinder_hardness, filter_size,
        particles, temperature,
    )  # fmt: skip
