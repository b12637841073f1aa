"""MIL-HDBK-217F(2) §15.2, sockets:  λp = λb · πP · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(TITLE, "15.2", "–", "three transcriptions agree; checked against Appendix A")

STYLE = Table("socket λb", SOURCE, """
    IC          0.00064  dual in line, single in line, chip carrier, pin grid array
    relay       0.037
    transistor  0.0051
    tube        0.011    electron tube, CRT
""")  # fmt: skip

QUALITY = Table("socket πQ", SOURCE, """
    MIL-SPEC  0.3
    lower     1.0
""")  # fmt: skip

ENVIRONMENT = Table("socket πE", SOURCE, """
    GB   1
    GF   3
    GM   14
    NS   6
    NU   18
    AIC  8
    AIF  12
    AUC  11
    AUF  13
    ARW  25
    SF   0.5
    MF   14
    ML   36
    CL   650
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(
            STYLE,
            "style of socket",
            aliases={"dip": "IC", "sip": "IC", "chip carrier": "IC", "pga": "IC", "crt": "tube"},
        ),
        "contacts": Range(1, 180, "", "active contacts", whole=True, monotone=1),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(style: str, contacts: Array, quality: str, environment: str) -> Factor:
    """λp = λb · πP · πQ · πE"""
    return (
        Factor("λb", STYLE[style], f"{style} {STYLE.notes[style]}".rstrip() + ", failures/10⁶ h")
        * Factor("πP", np.exp((np.maximum(np.asarray(contacts) - 1, 0) / 10) ** 0.39), "by active contacts")
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
