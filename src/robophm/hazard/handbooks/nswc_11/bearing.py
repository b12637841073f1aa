"""NSWC-11 §7 Eq 7-4, bearings of known load:  λ = 10⁶/L10h · C_R · C_ν · C_CW · C_t · C_SF · C_C   failures/10⁶ h

L10h = 10⁶/(60 n) · (L_S/L_A)^y, y = 3.0 of balls and 3.3 of rollers. The load is in L10h, and in no second factor.
"""

from __future__ import annotations

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product, size
from robophm.hazard.handbooks.nswc_11._bearing import AROUND, KIND, LOADS, SOURCE, around, load_factor
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": KIND,
        "speed": Range(0.0, 1e6, "rpm", "n", monotone=1),
        **LOADS,
        "dynamic_rating": Range(1e-3, 1e9, "N", "L_S, basic dynamic load rating C of the maker", monotone=-1),
        **AROUND,
    },
)
def hazard_rate(
    kind: str,
    speed: Array,
    load: Array,
    dynamic_rating: Array,
    service: str,
    cleanliness: str,
    bore: Array,
    specified_viscosity: Array,
    lubricant_viscosity: Array,
    water: Array,
    temperature: Array,
    reliability: Array,
) -> Factor:
    """λ = 10⁶/L10h · C_R · C_ν · C_CW · C_t · C_SF · C_C"""
    base = 60 * size(speed) * load_factor(kind, load, dynamic_rating)
    return product(
        (
            Factor("10⁶/L10h", base, "60 n · (L_A/L_S)^y, failures/10⁶ h"),
            *around(
                kind,
                service,
                cleanliness,
                bore,
                specified_viscosity,
                lubricant_viscosity,
                water,
                temperature,
                reliability,
            ),
            PER_HOUR,
        )
    )
