"""MIL-HDBK-217F(2) §17.1, connections:  λp = λb · πE   failures/10⁶ h

One connection; a terminal block and a spring contact count each of theirs. Joints of plated through holes are in §16.1.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Choice, Factor, hazard_model

SOURCE = Source(
    TITLE,
    "17.1",
    "–",
    "two transcriptions agree; checked against Appendix A, which has other base rates for hand solder, weld and wrap",
)

KIND = Table("connection λb", SOURCE, """
    hand-solder-no-wrap  0.0013     hand solder without wrapping
    hand-solder-wrapped  0.000070   hand solder with wrapping
    crimp                0.00026
    weld                 0.000015
    solderless-wrap      0.0000068
    clip-termination     0.00012
    reflow-solder        0.000069
    spring-contact       0.17
    terminal-block       0.062
""")  # fmt: skip

ENVIRONMENT = Table("connection πE", SOURCE, """
    GB   1
    GF   2
    GM   7
    NS   4
    NU   11
    AIC  4
    AIF  6
    AUC  6
    AUF  8
    ARW  16
    SF   0.5
    MF   9
    ML   24
    CL   420
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(
            KIND,
            "kind of connection",
            aliases={"hand solder": "hand-solder-no-wrap", "reflow": "reflow-solder", "wire wrap": "solderless-wrap"},
        ),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(kind: str, environment: str) -> Factor:
    """λp = λb · πE"""
    return (
        Factor("λb", KIND[kind], f"{kind} {KIND.notes[kind]}".rstrip() + ", failures/10⁶ h")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
