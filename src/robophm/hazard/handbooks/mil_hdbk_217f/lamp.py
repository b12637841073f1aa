"""MIL-HDBK-217F(2) §20.1, incandescent lamps:  λp = λb · πU · πA · πE   failures/10⁶ h

A lamp wears out within its robot's life: the rate is that of lamps that are replaced as they fail. An LED is no lamp.
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above, below
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(TITLE, "20.1", "–", "two transcriptions agree; one value of Appendix A (ac, GB) checked")

SUPPLY = Table("lamp πA", SOURCE, """
    ac  1.0
    dc  3.3
""")  # fmt: skip

ENVIRONMENT = Table("lamp πE", SOURCE, """
    GB   1
    GF   2
    GM   3
    NS   3
    NU   4
    AIC  4
    AIF  4
    AUC  5
    AUF  6
    ARW  5
    SF   0.7
    MF   4
    ML   6
    CL   27
""")  # fmt: skip

UTILISATION = 0.10, 0.72, 1.0  # lit below a tenth of the time, to nine tenths, above


@hazard_model(
    source=SOURCE,
    inputs={
        "rated_voltage": Range(0.1, 1e3, "V", "rated voltage", monotone=1),
        "utilisation": Range(0.0, 1.0, "", "share of the operating time in which it is lit", monotone=1),
        "supply": Choice(SUPPLY, "alternating or direct current"),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(rated_voltage: Array, utilisation: Array, supply: str, environment: str) -> Factor:
    """λp = λb · πU · πA · πE"""
    share = np.asarray(utilisation, dtype=float)
    low, middle, high = UTILISATION
    used = np.where(below(share, 0.10), low, np.where(above(share, 0.90), high, middle))
    return (
        Factor("λb", 0.074 * np.maximum(rated_voltage, 0.0) ** 1.29, "0.074 V^1.29, V rated, failures/10⁶ h")
        * Factor("πU", used, "share of the time lit: below 0.1, to 0.9, above")
        * Factor("πA", SUPPLY[supply], supply)
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
