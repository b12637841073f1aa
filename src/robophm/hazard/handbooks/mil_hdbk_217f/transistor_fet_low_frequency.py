"""MIL-HDBK-217F(2) §6.4, silicon field-effect transistors up to 400 MHz:

λp = λb · πT · πA · πQ · πE   failures/10⁶ h
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, below
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    ENVIRONMENT,
    QUALITY,
    junction_inputs,
    quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(TITLE, "6.4", "6-8", "two transcriptions agree; checked against Appendix A, small signals only")

KIND = Table("field-effect transistor type λb", SOURCE, """
    MOSFET  0.012
    JFET    0.0045
""")  # fmt: skip

APPLICATION = Table("field-effect transistor application πA below 2 W", SOURCE, """
    linear     1.5  linear amplification, rated below 2 W
    switching  0.7  small-signal switching, rated below 2 W
""")  # fmt: skip

POWER = Table("power field-effect transistor πA from a rated power on", SOURCE, """
    2    2.0
    5    4.0
    50   8.0
    250  10.0
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "MOSFET or junction FET"),
        "application": Choice(
            APPLICATION, "what it does; counts below 2 W", aliases={"amplifier": "linear", "switch": "switching"}
        ),
        **junction_inputs(),
        "rated_power": Range(1e-3, 1e4, "W", "rated power"),
        "quality": quality(),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    application: str,
    temperature: Array,
    power: Array,
    package: str,
    rated_power: Array,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πA · πQ · πE

    πA is by application below 2 W only: from 2 W on it is 2, 4, 8 or 10 by rated power, also of a switch. Quality is
    plastic, the worst, unless stated.
    """
    limits = [float(watts) for watts in POWER]
    by_power = np.array([APPLICATION[application], *POWER.values()])
    return (
        Factor("λb", KIND[kind], f"{kind}, failures/10⁶ h")
        * temperature_factor(1925, temperature, power, package, thermal_resistance)
        * Factor(
            "πA",
            by_power[sum((~below(rated_power, limit)).astype(int) for limit in limits)],
            f"{application}, {span(rated_power)} W rated power",
        )
        * closing(QUALITY, quality, ENVIRONMENT, environment)
    )
