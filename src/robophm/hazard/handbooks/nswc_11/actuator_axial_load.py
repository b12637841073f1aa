"""NSWC-11 §9, hydraulic and pneumatic actuators under axial load:  λ = 10⁶/N_O · C_CP · C_T   failures/10⁶ cycles

N_O = 17.7e3 · (γ·F_Y/(W_A · ((D1 − D2)/(D1·D2))²/K²)^(1/3))⁹ cycles, C_CP = C_H · C_S · C_N.
k2 = 17.7·10³ is unverified: contact mechanics gives about 4.3·10³, which would be a rate 4 times as high.
Seals are another part of the design. An electric actuator is a motor, a gear, bearings and a screw.
"""

from __future__ import annotations

import numpy as np

from robophm.hazard.handbooks.nswc_11 import POUND, size
from robophm.hazard.handbooks.nswc_11._actuator import AROUND, AXIAL, GEOMETRY, compliance, gap, wearing
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=AXIAL,
    unit="1/cycle",
    inputs={
        "load": Range(0.0, 1e8, "N", "W_A, along the axis", monotone=1),
        **GEOMETRY,
        **AROUND,
    },
)
def hazard_rate(
    load: Array,
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
    stress = np.cbrt(size(load) / POUND * curvature**2 / soft**2)  # psi, short of a constant
    return wearing(
        17.7e3, stress, outside, wear, material, yield_strength, particle_hardness, cylinder_hardness, filter_size,
        particles, temperature,
    )  # fmt: skip
