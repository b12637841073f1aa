"""NSWC-11 §4, wave washers:  λ = 1.9 · C_E · C_t · C_D · C_f · C_Y · C_NW · C_CS · C_R · C_M   failures/10⁶ h"""

from __future__ import annotations

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product, size
from robophm.hazard.handbooks.nswc_11._spring import COMMON, ELASTIC, OTHERS, common, elasticity, length, ratio
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=OTHERS,
    inputs={
        **ELASTIC,
        "thickness": length(0.01, 50.0, "t", 1),
        "outer_diameter": length(0.5, 1000.0, "OD", -1),
        "deflection": length(1e-3, 500.0, "f, by which it is bent", 1),
        "waves": Range(1.0, 100.0, "", "N_W, how many", whole=True, monotone=-1),
        **COMMON,
    },
)
def hazard_rate(
    material: str,
    thickness: Array,
    outer_diameter: Array,
    deflection: Array,
    waves: Array,
    alloy: str,
    cycle_rate: Array,
    corrosion: Array,
    manufacture: Array,
    tensile_strength: Array | None = None,
    elastic_modulus: Array | None = None,
) -> Factor:
    """λ = 1.9 · C_E · C_t · C_D · C_f · C_Y · C_NW · C_CS · C_R · C_M"""
    return product(
        (
            Factor("λB", 1.9, "failures/10⁶ h"),
            elasticity(material, elastic_modulus),
            ratio("C_t", thickness, 0.025, 3, "(t/0.025 in)³"),
            ratio("C_D", outer_diameter, 1.20, -6, "(1.20 in/OD)⁶"),
            ratio("C_f", deflection, 0.055, 3, "(f/0.055 in)³"),
            Factor("C_NW", (5 / size(waves)) ** 2, "(5/N_W)²"),
            *common(alloy, tensile_strength, cycle_rate, corrosion, manufacture),
            PER_HOUR,
        )
    )
