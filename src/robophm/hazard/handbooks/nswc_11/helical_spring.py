"""NSWC-11 §4, helical springs:  λ = 23.8 · C_G · C_DW · C_DC · C_N · C_Y · C_L · C_K · C_CS · C_R · C_M  failures/10⁶ h

Of compression springs, and of extension springs, all of whose coils are active. C_K is of Wahl's factor
K_W = (4r − 1)/(4r − 4) + 0.616/r with the spring index r = D_C/D_W above 1.
"""

from __future__ import annotations

import numpy as np

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product, size
from robophm.hazard.handbooks.nswc_11._spring import COMMON, HELICAL, SHEAR, common, length, ratio, rigidity
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=HELICAL,
    inputs={
        **SHEAR,
        "wire_diameter": length(0.05, 50.0, "D_W", 1),
        "coil_diameter": length(0.2, 1000.0, "D_C, mean diameter of the coils", -1),
        "active_coils": Range(0.5, 500.0, "", "N_a; of an extension spring all", monotone=-1),
        "deflection": length(1e-3, 2000.0, "L1 − L2, from the one end of its movement to the other", 1),
        **COMMON,
    },
)
def hazard_rate(
    material: str,
    wire_diameter: Array,
    coil_diameter: Array,
    active_coils: Array,
    deflection: Array,
    alloy: str,
    cycle_rate: Array,
    corrosion: Array,
    manufacture: Array,
    tensile_strength: Array | None = None,
    shear_modulus: Array | None = None,
) -> Factor:
    """λ = 23.8 · C_G · C_DW · C_DC · C_N · C_Y · C_L · C_K · C_CS · C_R · C_M"""
    index = size(coil_diameter) / size(wire_diameter)
    r = np.maximum(index, 1.001)  # beyond the pole at 1, which no spring reaches, the factor would turn over
    wahl = (4 * r - 1) / (4 * r - 4) + 0.616 / r
    return product(
        (
            Factor("λB", 23.8, "failures/10⁶ h"),
            rigidity(material, shear_modulus),
            ratio("C_DW", wire_diameter, 0.085, 3, "(D_W/0.085 in)³"),
            ratio("C_DC", coil_diameter, 0.58, -6, "(0.58 in/D_C)⁶"),
            Factor("C_N", (14 / size(active_coils)) ** 3, "(14/N_a)³"),
            ratio("C_L", deflection, 1.07, 3, "((L1 − L2)/1.07 in)³"),
            Factor(
                "C_K",
                (wahl / 1.219) ** 3,
                "(K_W/1.219)³, spring index D_C/D_W above 1",
                outside=index <= 1,
                beyond=lambda: "the coil's diameter is not larger than the wire's",
            ),
            *common(alloy, tensile_strength, cycle_rate, corrosion, manufacture),
            PER_HOUR,
        )
    )
