"""MIL-HDBK-217F(2) §12.2, synchros and resolvers:  λp = λb · πS · πN · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above, band
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import surroundings
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(TITLE, "12.2", "12-4", "two transcriptions agree; λb checked against its printed table by a third")

KIND = Table("synchro and resolver size πS", SOURCE, """
    synchro   2  1.5   1
    resolver  3  2.25  1.5
""", columns=("size up to 8", "10 to 16", "18 and more"))  # fmt: skip

BRUSHES = (2.0, 3.0, np.inf), (1.4, 2.5, 3.2)
"""Upper limits of the number of brushes, and πN; 2 means two or fewer."""

ENVIRONMENT = Table("synchro and resolver environment πE", SOURCE, """
    GB   1.0
    GF   2.0
    GM   12.0
    NS   7.0
    NU   18.0
    AIC  4.0
    AIF  6.0
    AUC  16.0
    AUF  25.0
    ARW  26.0
    SF   0.5
    MF   14.0
    ML   36.0
    CL   680.0
""")  # fmt: skip

HOTTEST = 135.0  # °C of the frame


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "synchro or resolver"),
        "temperature": Range(-55.0, HOTTEST, "degC", "ambient temperature", monotone=1, warmth="ambient"),
        "frame_rise": Range(
            0.0, 150.0, "K", "frame above ambient; 40 K where it is unknown, as printed", default=40.0, monotone=1
        ),
        "size": Range(1.0, 50.0, "", "frame size", monotone=-1),
        "brushes": Range(0.0, 4.0, "", "number of brushes", whole=True, monotone=1),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    frame_rise: Array,
    size: Array,
    brushes: Array,
    environment: str,
) -> Factor:
    """λp = λb · πS · πN · πE

    λb = 0.00535 · exp(((TF + 273)/334)^8.5) at the frame's temperature TF.
    """
    frame = np.asarray(temperature) + np.asarray(frame_rise)
    kelvin = np.clip(frame + 273, 1.0, 500.0)  # what a broken sensor says must not make it infinite
    return (
        Factor(
            "λb",
            0.00535 * np.exp((kelvin / 334) ** 8.5),
            f"frame at {span(frame)} °C (up to {HOTTEST:g}), failures/10⁶ h",
            outside=above(frame, HOTTEST),
            beyond=more_than("the temperature of the frame", frame, "the handbook's", HOTTEST, "°C"),
        )
        * Factor("πS", band(size, (8.0, 16.0, np.inf), KIND.rows[kind]), f"{kind}, size {span(size)}")
        * Factor("πN", band(brushes, *BRUSHES), f"{span(brushes)} brushes")
        * surroundings(ENVIRONMENT, environment)
    )
