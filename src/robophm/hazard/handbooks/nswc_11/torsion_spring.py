"""NSWC-11 §4, torsion springs:  λ = 14.3 · C_E · C_DW · C_N · C_Y · C_L · C_CS · C_DC · C_R · C_M   failures/10⁶ h"""

from __future__ import annotations

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product, size
from robophm.hazard.handbooks.nswc_11._spring import COMMON, ELASTIC, OTHERS, common, elasticity, length, ratio
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=OTHERS,
    inputs={
        **ELASTIC,
        "wire_diameter": length(0.05, 50.0, "D_W", 1),
        "coil_diameter": length(0.2, 1000.0, "D_C, mean diameter of the coils", -1),
        "active_coils": Range(0.5, 500.0, "", "N_a", monotone=-1),
        "angle": Range(0.1, 36000.0, "deg", "θ, by which it is turned", monotone=1),
        **COMMON,
    },
)
def hazard_rate(
    material: str,
    wire_diameter: Array,
    coil_diameter: Array,
    active_coils: Array,
    angle: Array,
    alloy: str,
    cycle_rate: Array,
    corrosion: Array,
    manufacture: Array,
    tensile_strength: Array | None = None,
    elastic_modulus: Array | None = None,
) -> Factor:
    """λ = 14.3 · C_E · C_DW · C_N · C_Y · C_L · C_CS · C_DC · C_R · C_M"""
    return product(
        (
            Factor("λB", 14.3, "failures/10⁶ h"),
            elasticity(material, elastic_modulus),
            ratio("C_DW", wire_diameter, 0.085, 3, "(D_W/0.085 in)³"),
            Factor("C_N", (14 / size(active_coils)) ** 3, "(14/N_a)³"),
            Factor("C_L", (size(angle) / 360 / 0.667) ** 3, "(θ/0.667 revolutions)³"),
            ratio("C_DC", coil_diameter, 0.58, -3, "(0.58 in/D_C)³"),
            *common(alloy, tensile_strength, cycle_rate, corrosion, manufacture),
            PER_HOUR,
        )
    )
