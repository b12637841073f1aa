"""MIL-HDBK-217F(2) §15.1, connectors but sockets:  λp = λb · πT · πK · πQ · πE   failures/10⁶ h

For a mated pair; one half of it has half the rate.
"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import (
    TITLE,
    handbook_arrhenius,
    per_million_hours,
    span,
    steps,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(
    TITLE,
    "15.1",
    "–",
    "two transcriptions agree; circular and card edge checked against Appendix A, whose rectangular row is misprinted",
)

STYLE = Table("connector λb", SOURCE, """
    circular          0.0010
    card-edge         0.040   printed circuit board edge
    hexagonal         0.15
    rack-panel        0.021   rack and panel
    rectangular       0.046
    rf-coaxial        0.00041 insert 5 °C warmer, whatever the current
    rf-coaxial-power  0.00041 high-power RF: insert 50 °C warmer, whatever the current
    telephone         0.0075
    power             0.0070
    triaxial          0.0036
""")  # fmt: skip

WIRE = Table("insert temperature rise by AWG", SOURCE, """
    32  3.256
    30  2.856
    28  2.286
    24  1.345
    22  0.989
    20  0.640
    18  0.429
    16  0.274
    12  0.100
""")  # fmt: skip

MATING = Table("connector πK", SOURCE, """
    0.05  1.0
    0.5   1.5
    5     2.0
    50    3.0
    inf   4.0
""")  # fmt: skip

QUALITY = Table("connector πQ", SOURCE, """
    MIL-SPEC  1
    lower     2
""")  # fmt: skip

ENVIRONMENT = Table("connector πE", SOURCE, """
    GB   1
    GF   1
    GM   8
    NS   5
    NU   13
    AIC  3
    AIF  5
    AUC  8
    AUF  12
    ARW  19
    SF   0.5
    MF   10
    ML   27
    CL   490
""")  # fmt: skip

HALVES = {"mated pair": 1.0, "one half": 0.5}
RADIO_FREQUENCY_RISE = {"rf-coaxial": 5.0, "rf-coaxial-power": 50.0}  # °C


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(
            STYLE,
            "style of connector",
            aliases={
                "edge": "card-edge", "d-sub": "rack-panel", "header": "rectangular", "pin header": "rectangular",
                "sma": "rf-coaxial", "bnc": "rf-coaxial", "m12": "circular", "rj45": "telephone", "rj11": "telephone",
            },
        ),
        "temperature": Range(-55.0, 250.0, "degC", "ambient temperature", monotone=1, warmth="ambient"),
        "current": Range(0.0, 60.0, "A", "current of a contact; all but RF need it", required=False, monotone=1),
        "wire_gauge": Choice(WIRE, "AWG of a contact's wire; all but RF need it", required=False),
        "matings": Range(0.0, 1e5, "/10^3 h", "matings and unmatings", monotone=1),
        "half": Choice(tuple(HALVES), "a mated pair, or one half of it", default="mated pair"),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT),
    },
)  # fmt: skip
def hazard_rate(
    style: str,
    temperature: Array,
    matings: Array,
    half: str,
    quality: str,
    environment: str,
    current: Array | None = None,
    wire_gauge: str | None = None,
) -> Factor:
    """λp = λb · πT · πK · πQ · πE"""
    if style in RADIO_FREQUENCY_RISE:
        rise: Array | float = RADIO_FREQUENCY_RISE[style]
    elif current is None or wire_gauge is None:
        raise ModelError(f"mil_hdbk_217f.connector: style {style} needs 'current' (A of a contact) and 'wire_gauge'")
    else:
        rise = WIRE[wire_gauge] * np.abs(current) ** 1.85
    insert = np.asarray(temperature) + rise
    return (
        Factor("λb", STYLE[style], f"{style} {STYLE.notes[style]}".rstrip() + ", failures/10⁶ h")
        * Factor(
            "πT",
            handbook_arrhenius(insert, 0.14),
            f"insert at {span(insert)} °C of at most 250, Ea = 0.14 eV",
            outside=above(insert, 250.0),
            beyond=more_than("the temperature of the insert", insert, "the handbook's", 250.0, "°C"),
        )
        * Factor("πK", steps(MATING, matings), "matings and unmatings in 1000 h")
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * Factor("of a pair", HALVES[half], half)
        * per_million_hours()
    )
