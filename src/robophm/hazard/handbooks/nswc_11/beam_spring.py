"""NSWC-11 §4, beam springs:  λ = 4.4 · C_E · C_t · C_L · C_f · C_Y · C_CS · C_R · C_M   failures/10⁶ h"""

from __future__ import annotations

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product
from robophm.hazard.handbooks.nswc_11._spring import COMMON, ELASTIC, OTHERS, common, elasticity, length, ratio
from robophm.hazard.model import Array, Factor, hazard_model


@hazard_model(
    source=OTHERS,
    inputs={
        **ELASTIC,
        "thickness": length(0.01, 50.0, "t", 1),
        "span": length(0.5, 2000.0, "L, length that bends", -1),
        "deflection": length(1e-3, 500.0, "f, by which it is bent", 1),
        **COMMON,
    },
)
def hazard_rate(
    material: str,
    thickness: Array,
    span: Array,
    deflection: Array,
    alloy: str,
    cycle_rate: Array,
    corrosion: Array,
    manufacture: Array,
    tensile_strength: Array | None = None,
    elastic_modulus: Array | None = None,
) -> Factor:
    """λ = 4.4 · C_E · C_t · C_L · C_f · C_Y · C_CS · C_R · C_M"""
    return product(
        (
            Factor("λB", 4.4, "failures/10⁶ h"),
            elasticity(material, elastic_modulus),
            ratio("C_t", thickness, 0.025, 3, "(t/0.025 in)³"),
            ratio("C_L", span, 1.20, -6, "(1.20 in/L)⁶"),
            ratio("C_f", deflection, 0.055, 3, "(f/0.055 in)³"),
            *common(alloy, tensile_strength, cycle_rate, corrosion, manufacture),
            PER_HOUR,
        )
    )
