"""MIL-HDBK-217F(2) §14.2, circuit breakers:  λp = λb · πC · πU · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Choice, Factor, hazard_model

SOURCE = Source(TITLE, "14.2", "–", "two transcriptions agree; checked against Appendix A; no πE for CL")

POLES = Table("circuit breaker πC", SOURCE, """
    SPST  1.0
    DPST  2.0
    3PST  3.0
    4PST  4.0
""")  # fmt: skip

USE = Table("circuit breaker πU", SOURCE, """
    breaker-only  1.0  not used as a switch
    also-switch   2.5  also used as a power on/off switch
""")  # fmt: skip

QUALITY = Table("circuit breaker πQ", SOURCE, """
    MIL-SPEC  1.0
    lower     8.4
""")  # fmt: skip

ENVIRONMENT = Table("circuit breaker πE", SOURCE, """
    GB   1
    GF   2
    GM   15
    NS   8
    NU   27
    AIC  7
    AIF  9
    AUC  11
    AUF  12
    ARW  46
    SF   0.5
    MF   25
    ML   66
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "poles": Choice(POLES, "form of the contacts", aliases={"1": "SPST", "2": "DPST", "3": "3PST", "4": "4PST"}),
        "use": Choice(USE, "whether it is also the switch"),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT, but="none for CL"),
    },
)
def hazard_rate(poles: str, use: str, quality: str, environment: str) -> Factor:
    """λp = λb · πC · πU · πQ · πE"""
    return (
        Factor("λb", 0.34, "every kind, failures/10⁶ h")
        * Factor("πC", POLES[poles], poles)
        * Factor("πU", USE[use], USE.notes[use])
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
