"""MIL-HDBK-217F(2) §19.1, quartz crystals:  λp = λb · πQ · πE   failures/10⁶ h

The frequency of λb = 0.013 f^0.23 is in MHz. A packaged oscillator is a crystal and a microcircuit or hybrid.
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(TITLE, "19.1", "–", "four transcriptions agree, and Appendix A; λb is printed from 0.5 to 105 MHz")

QUALITY = Table("crystal πQ", SOURCE, """
    MIL-SPEC  1.0
    lower     2.1
""")  # fmt: skip

ENVIRONMENT = Table("crystal πE", SOURCE, """
    GB   1
    GF   3
    GM   10
    NS   6
    NU   16
    AIC  12
    AIF  17
    AUC  22
    AUF  28
    ARW  23
    SF   0.5
    MF   13
    ML   32
    CL   500
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "frequency": Range(1e-3, 105.0, "MHz", "frequency; below 0.5 MHz by the equation", monotone=1),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(frequency: Array, quality: str, environment: str) -> Factor:
    """λp = λb · πQ · πE"""
    return (
        Factor("λb", 0.013 * np.maximum(frequency, 0.0) ** 0.23, "0.013 f^0.23, f in MHz, failures/10⁶ h")
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
