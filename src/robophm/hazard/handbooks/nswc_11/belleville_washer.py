"""NSWC-11 §4, Belleville washers:  λ = 2.6 · C_E · C_t · C_D · C_f · C_Y · C_S · C_CS · C_R · C_M   failures/10⁶ h

C_S = (6/(π ln R))³ · ((R − 1)/ln R − 1) · (R − 1)/2 · (R − 1)²/R² with R = OD/ID: the product of the three constants
of Almen and László's theory. One transcription has it.
"""

from __future__ import annotations

import numpy as np

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product, size
from robophm.hazard.handbooks.nswc_11._spring import COMMON, ELASTIC, OTHERS, common, elasticity, length, ratio
from robophm.hazard.model import Array, Factor, hazard_model


@hazard_model(
    source=OTHERS,
    inputs={
        **ELASTIC,
        "thickness": length(0.01, 50.0, "t", 1),
        "outer_diameter": length(0.5, 1000.0, "OD", 0),
        "deflection": length(1e-3, 500.0, "f, by which it is bent", 1),
        "inner_diameter": length(0.2, 999.0, "ID", 0),
        **COMMON,
    },
)
def hazard_rate(
    material: str,
    thickness: Array,
    outer_diameter: Array,
    deflection: Array,
    inner_diameter: Array,
    alloy: str,
    cycle_rate: Array,
    corrosion: Array,
    manufacture: Array,
    tensile_strength: Array | None = None,
    elastic_modulus: Array | None = None,
) -> Factor:
    """λ = 2.6 · C_E · C_t · C_D · C_f · C_Y · C_S · C_CS · C_R · C_M"""
    R = size(outer_diameter) / size(inner_diameter)
    safe = np.maximum(R, 1.001)  # at 1 there is no washer, and the factor is 0/0
    log = np.log(safe)
    shape = (6 / (np.pi * log)) ** 3 * ((safe - 1) / log - 1) * (safe - 1) / 2 * ((safe - 1) / safe) ** 2
    return product(
        (
            Factor("λB", 2.6, "failures/10⁶ h"),
            elasticity(material, elastic_modulus),
            ratio("C_t", thickness, 0.025, 3, "(t/0.025 in)³"),
            ratio("C_D", outer_diameter, 1.20, -6, "(1.20 in/OD)⁶"),
            ratio("C_f", deflection, 0.055, 3, "(f/0.055 in)³"),
            Factor(
                "C_S",
                shape,
                "of OD/ID, which is above 1",
                outside=R < 1.001,
                beyond=lambda: "the outer diameter is not larger than the inner one",
            ),
            *common(alloy, tensile_strength, cycle_rate, corrosion, manufacture),
            PER_HOUR,
        )
    )
