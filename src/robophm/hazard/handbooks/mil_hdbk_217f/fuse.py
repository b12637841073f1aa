"""MIL-HDBK-217F(2) §22.1, fuses:  λp = λb · πE   failures/10⁶ h

Fuses of electronic equipment (W-F-1726, W-F-1814, MIL-F-5372, MIL-F-23419, MIL-F-15160) alone. A resettable fuse (PPTC)
has no model in the handbook: use the thermistor's or a maker's figure, and say so.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Factor, hazard_model

SOURCE = Source(TITLE, "22.1", "–", "four transcriptions agree, and Appendix A")

ENVIRONMENT = Table("fuse πE", SOURCE, """
    GB   1
    GF   2
    GM   8
    NS   5
    NU   11
    AIC  9
    AIF  12
    AUC  15
    AUF  18
    ARW  16
    SF   0.9
    MF   10
    ML   21
    CL   230
""")  # fmt: skip


@hazard_model(source=SOURCE, inputs={"environment": environment_choice(ENVIRONMENT)})
def hazard_rate(environment: str) -> Factor:
    """λp = λb · πE"""
    return (
        Factor("λb", 0.010, "every fuse, failures/10⁶ h")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
