"""MIL-HDBK-217F(2) §6.2, high-frequency (microwave, RF) diodes:  λp = λb · πT · πA · πR · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    COMMERCIAL_IS_PLASTIC,
    RF_ENVIRONMENT,
    junction_inputs,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "6.2",
    "6-4 … 6-5",
    "two transcriptions agree; checked against Appendix A; that πR ends at 3000 W is from one of them",
)

KIND = Table("high-frequency diode type", SOURCE, """
    impatt     0.22    5260  silicon IMPATT, up to 35 GHz
    gunn       0.18    2100  Gunn, bulk effect
    tunnel     0.0023  2100  tunnel and back, mixers and detectors among them
    pin        0.0081  2100  PIN
    schottky   0.027   2100  Schottky barrier and point contact, 0.2 to 35 GHz, detectors among them
    varactor   0.0025  2100  varactor and step recovery
""", columns=("λb", "B"))  # fmt: skip

APPLICATION = Table("high-frequency diode application πA", SOURCE, """
    varactor_voltage_control  0.5  varactor, voltage control
    varactor_multiplier       2.5  varactor, multiplier
    other                     1.0  all other diodes
""")  # fmt: skip

QUALITY = Table("high-frequency diode quality πQ", SOURCE, """
    JANTXV   0.5
    JANTX    1.0
    JAN      5.0
    lower    25.0
    plastic  50.0
""")  # fmt: skip

SCHOTTKY_QUALITY = Table("high-frequency Schottky diode quality πQ", SOURCE, """
    JANTXV  0.5
    JANTX   1.0
    JAN     1.8
    lower   2.5
""")  # fmt: skip

ALIASES = {
    "gunn effect": "gunn",
    "bulk effect": "gunn",
    "tunnel diode": "tunnel",
    "back": "tunnel",
    "pin diode": "pin",
    "schottky barrier": "schottky",
    "point contact": "schottky",
    "step recovery": "varactor",
    "varicap": "varactor",
}


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "type of the diode", aliases=ALIASES),
        **junction_inputs(),
        "application": Choice(APPLICATION, "application; only a varactor is not 'other'", default="other"),
        "rated_power": Range(1e-3, 3000.0, "W", "rated power; a PIN diode needs it", required=False),
        "quality": Choice(QUALITY, "quality level; Schottky has no plastic", aliases=COMMERCIAL_IS_PLASTIC),
        "environment": environment_choice(RF_ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    power: Array,
    package: str,
    application: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
    rated_power: Array | None = None,
) -> Factor:
    """λp = λb · πT · πA · πR · πQ · πE

    πR is of PIN diodes alone: 0.5 up to 10 W, 0.326 ln(P) − 0.25 up to 3000 W. The handbook has no default quality.
    """
    if application != "other" and kind != "varactor":
        raise ModelError(f"mil_hdbk_217f.diode_high_frequency: application {application} is of a varactor, not {kind}")
    table = SCHOTTKY_QUALITY if kind == "schottky" else QUALITY
    if quality not in table:
        raise ModelError(f"mil_hdbk_217f.diode_high_frequency: the handbook has no quality '{quality}' for {kind}")
    if kind != "pin":
        rating = Factor("πR", 1.0, f"1 for a {kind}")
    elif rated_power is None:
        raise ModelError("mil_hdbk_217f.diode_high_frequency: kind pin needs 'rated_power' (W)")
    else:
        watts = np.asarray(rated_power)
        rating = Factor(
            "πR",
            np.where(above(watts, 10.0), 0.326 * np.log(np.maximum(watts, 10.0)) - 0.25, 0.5),
            f"PIN of {span(watts)} W rated power",
        )
    return (
        Factor("λb", KIND[kind], f"{KIND.notes[kind]}, failures/10⁶ h")
        * temperature_factor(KIND.cell(kind, "B"), temperature, power, package, thermal_resistance)
        * Factor("πA", APPLICATION[application], APPLICATION.notes[application])
        * rating
        * closing(table, quality, RF_ENVIRONMENT, environment)
    )
