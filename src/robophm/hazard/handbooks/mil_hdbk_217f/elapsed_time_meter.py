"""MIL-HDBK-217F(2) §12.3, elapsed-time meters:  λp = λb · πT · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above, band
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import surroundings
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(TITLE, "12.3", "12-5", "two transcriptions agree; checked against Appendix A")

KIND = Table("elapsed-time meter type λb", SOURCE, """
    ac               20
    inverter_driven  30
    commutator_dc    80
""")  # fmt: skip

TEMPERATURE = (0.5, 0.6, 0.8, np.inf), (0.5, 0.6, 0.8, 1.0)
"""Upper limits of the ratio of operating to rated temperature in °C, and πT; above 1 there is none."""

ENVIRONMENT = Table("elapsed-time meter environment πE", SOURCE, """
    GB   1.0
    GF   2.0
    GM   12.0
    NS   7.0
    NU   18.0
    AIC  5.0
    AIF  8.0
    AUC  16.0
    AUF  25.0
    ARW  26.0
    SF   0.5
    MF   14.0
    ML   38.0
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "drive of the meter", aliases={"dc": "commutator_dc", "inverter": "inverter_driven"}),
        "temperature": Range(-55.0, 200.0, "degC", "operating temperature", monotone=1, warmth="own"),
        "rated_temperature": Range(1.0, 200.0, "degC", "largest rated temperature", monotone=-1),
        "environment": environment_choice(ENVIRONMENT, but="the handbook has no cannon launch"),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    rated_temperature: Array,
    environment: str,
) -> Factor:
    """λp = λb · πT · πE

    πT goes by the ratio of operating to rated temperature, both in °C, up to 1.
    """
    ratio = np.asarray(temperature) / np.asarray(rated_temperature)
    return (
        Factor("λb", KIND[kind], f"{kind}, failures/10⁶ h")
        * Factor(
            "πT",
            band(ratio, *TEMPERATURE),
            f"operating by rated temperature {span(ratio)} of at most 1",
            outside=above(ratio, 1.0),
            beyond=more_than(
                "the operating temperature", temperature, "the rated temperature", rated_temperature, "°C"
            ),
        )
        * surroundings(ENVIRONMENT, environment)
    )
