"""MIL-HDBK-217F(2) §18.1, panel meters:  λp = λb · πA · πF · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Choice, Factor, hazard_model

SOURCE = Source(TITLE, "18.1", "–", "two transcriptions agree; checked against Appendix A; no πE for ML and CL")

APPLICATION = Table("panel meter πA", SOURCE, """
    dc  1.0
    ac  1.7
""")  # fmt: skip

FUNCTION = Table("panel meter πF", SOURCE, """
    ammeter    1.0
    voltmeter  1.0
    other      2.8
""")  # fmt: skip

QUALITY = Table("panel meter πQ", SOURCE, """
    MIL-SPEC  1.0  MIL-M-10304
    lower     3.4
""")  # fmt: skip

ENVIRONMENT = Table("panel meter πE", SOURCE, """
    GB   1
    GF   4
    GM   25
    NS   12
    NU   35
    AIC  28
    AIF  42
    AUC  58
    AUF  73
    ARW  60
    SF   1.1
    MF   60
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "application": Choice(APPLICATION, "direct or alternating current"),
        "function": Choice(FUNCTION, "what it measures"),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT, but="none for ML, CL"),
    },
)
def hazard_rate(application: str, function: str, quality: str, environment: str) -> Factor:
    """λp = λb · πA · πF · πQ · πE"""
    return (
        Factor("λb", 0.090, "every meter, failures/10⁶ h")
        * Factor("πA", APPLICATION[application], application)
        * Factor("πF", FUNCTION[function], function)
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
