"""NSWC-11 §7, bearings of rated life:  λ = 10⁶/L10h · C_Y · C_R · C_ν · C_CW · C_t · C_SF · C_C   failures/10⁶ h

C_Y = (L_A/L_S)^y carries from the load of which the maker states the L10 life to the load as operated.
"""

from __future__ import annotations

from robophm.hazard.handbooks.nswc_11 import PER_HOUR, product, size
from robophm.hazard.handbooks.nswc_11._bearing import AROUND, KIND, LOADS, SOURCE, around, load_factor
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": KIND,
        "rated_life": Range(1.0, 1e9, "h", "L10h that the maker states", monotone=-1),
        **LOADS,
        "specified_load": Range(1e-3, 1e8, "N", "L_S, load of which the rated life is", monotone=-1),
        **AROUND,
    },
)
def hazard_rate(
    kind: str,
    rated_life: Array,
    load: Array,
    specified_load: Array,
    service: str,
    cleanliness: str,
    bore: Array,
    specified_viscosity: Array,
    lubricant_viscosity: Array,
    water: Array,
    temperature: Array,
    reliability: Array,
) -> Factor:
    """λ = 10⁶/L10h · C_Y · C_R · C_ν · C_CW · C_t · C_SF · C_C"""
    return product(
        (
            Factor("10⁶/L10h", 1e6 / size(rated_life), "failures/10⁶ h at the load of the rated life"),
            Factor("C_Y", load_factor(kind, load, specified_load), "(L_A/L_S)^y"),
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
