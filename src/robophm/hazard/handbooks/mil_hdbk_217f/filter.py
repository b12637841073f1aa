"""MIL-HDBK-217F(2) §21.1, electronic filters:  λp = λb · πQ · πE   failures/10⁶ h

Non-tunable filters as parts; one built of its parts on a board is the sum of them.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Choice, Factor, hazard_model

SOURCE = Source(TITLE, "21.1", "–", "two transcriptions agree; one value of Appendix A (ceramic-ferrite, GB) checked")

STYLE = Table("filter λb", SOURCE, """
    ceramic-ferrite             0.022  MIL-F-15733
    discrete-LC                 0.12   MIL-F-15733, of discrete L and C
    discrete-LC-composition-1   0.12   MIL-F-18327, composition 1
    discrete-LC-crystal         0.27   MIL-F-18327, of discrete L, C and crystals, composition 2
""")  # fmt: skip

QUALITY = Table("filter πQ", SOURCE, """
    MIL-SPEC  1.0
    lower     2.9
""")  # fmt: skip

ENVIRONMENT = Table("filter πE", SOURCE, """
    GB   1
    GF   2
    GM   6
    NS   4
    NU   9
    AIC  7
    AIF  9
    AUC  11
    AUF  13
    ARW  11
    SF   0.8
    MF   7
    ML   15
    CL   120
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(STYLE, "construction"),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(style: str, quality: str, environment: str) -> Factor:
    """λp = λb · πQ · πE"""
    return (
        Factor("λb", STYLE[style], f"{style}: {STYLE.notes[style]}, failures/10⁶ h")
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
