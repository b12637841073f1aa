"""MIL-HDBK-217F(2) §13.2, solid-state relays:  λp = λb · πQ · πE   failures/10⁶ h

Solid-state, solid-state time-delay and hybrid relays alike. The load does not count.
λb and πQ are from one transcription.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Choice, Factor, hazard_model

SOURCE = Source(TITLE, "13.2", "–", "λb and πQ from a single transcription, πE from two; no published answer")

QUALITY = Table("solid-state relay πQ", SOURCE, """
    MIL-SPEC    1.0
    commercial  1.9
""")  # fmt: skip

ENVIRONMENT = Table("solid-state relay πE", SOURCE, """
    GB   1
    GF   3
    GM   12
    NS   6
    NU   17
    AIC  12
    AIF  19
    AUC  21
    AUF  32
    ARW  23
    SF   0.4
    MF   12
    ML   33
    CL   590
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "quality": Choice(QUALITY, "quality level", default="commercial", aliases={"lower": "commercial"}),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(quality: str, environment: str) -> Factor:
    """λp = λb · πQ · πE"""
    return (
        Factor("λb", 0.029, "every kind, failures/10⁶ h")
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
