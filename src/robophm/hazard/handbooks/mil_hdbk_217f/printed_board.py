"""MIL-HDBK-217F(2) §16.1, boards with plated through holes:  λp = λb · (N1 · πC + N2 · (πC + 13)) · πQ · πE

failures/10⁶ h. The board and its joints, without its parts; surface-mounted parts wear by §16.2.
"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, per_million_hours
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(TITLE, "16.1", "–", "two transcriptions agree; one value of Appendix A (GB, 3 planes) checked")

TECHNOLOGY = Table("plated through holes λb", SOURCE, """
    printed   0.000017  printed wiring or circuit board
    discrete  0.00011   discrete wiring with electroless-deposited plated through holes, up to 2 levels
""")  # fmt: skip

QUALITY = Table("plated through holes πQ", SOURCE, """
    MIL-SPEC  1  or IPC level 3
    lower     2
""")  # fmt: skip

ENVIRONMENT = Table("plated through holes πE", SOURCE, """
    GB   1
    GF   2
    GM   7
    NS   5
    NU   13
    AIC  5
    AIF  8
    AUC  16
    AUF  28
    ARW  19
    SF   0.5
    MF   10
    ML   27
    CL   500
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "technology": Choice(TECHNOLOGY, "technology of the board"),
        "automated_holes": Range(
            0, 1e6, "", "N1, plated through holes soldered by wave or vapour phase", whole=True, monotone=1
        ),
        "hand_soldered_holes": Range(0, 1e6, "", "N2, plated through holes soldered by hand", whole=True, monotone=1),
        "planes": Range(
            2, 18, "", "circuit planes; a printed board needs them", whole=True, required=False, monotone=1
        ),
        "quality": Choice(
            QUALITY, "quality level", default="lower", aliases={"ipc level 3": "MIL-SPEC", "commercial": "lower"}
        ),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    technology: str,
    automated_holes: Array,
    hand_soldered_holes: Array,
    quality: str,
    environment: str,
    planes: Array | None = None,
) -> Factor:
    """λp = λb · (N1 · πC + N2 · (πC + 13)) · πQ · πE"""
    if technology == "discrete":
        complexity, note = np.asarray(1.0), "1 for discrete wiring"
    elif planes is None:
        raise ModelError("mil_hdbk_217f.printed_board: a printed board needs 'planes' (2 … 18)")
    else:
        complexity, note = 0.65 * np.maximum(planes, 0.0) ** 0.63, "0.65 P^0.63 by planes"
    holes = Factor("N1", np.asarray(automated_holes), "holes soldered by machine") * Factor("πC", complexity, note)
    by_hand = Factor("N2", np.asarray(hand_soldered_holes), "holes soldered by hand")
    return (
        Factor("λb", TECHNOLOGY[technology], f"{technology}, failures/10⁶ h")
        * (holes + by_hand * Factor("πC + 13", complexity + 13, note))
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )
