"""MIL-HDBK-217F(2) §6.13, laser diodes:  λp = λb · πT · πQ · πI · πA · πP · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    OPTICAL_ENVIRONMENT,
    junction_inputs,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(
    TITLE,
    "6.13",
    "6-21 … 6-22",
    "two transcriptions agree; checked against Appendix A as one program has it; a third reading has B = 2790 of "
    "other optoelectronics, which Appendix A contradicts; the limits of 25 A and of 25 to 75 °C are from one program",
)

KIND = Table("laser diode λb", SOURCE, """
    GaAs_AlGaAs     3.23
    InGaAs_InGaAsP  5.65
""")  # fmt: skip

QUALITY = Table("laser diode quality πQ", SOURCE, """
    hermetic              1.0  hermetic package
    nonhermetic_coated    1.0  nonhermetic, with facet coating
    nonhermetic_uncoated  3.3  nonhermetic, without facet coating
""")  # fmt: skip

LARGEST_RATIO = 0.95


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "material"),
        **junction_inputs(hottest=75.0),
        "current": Range(1e-6, 25.0, "A", "forward peak current", monotone=1),
        "application": Choice(("cw", "pulsed"), "continuous wave or pulsed", aliases={"continuous": "cw"}),
        "duty": Range(0.0, 1.0, "", "share of time in pulses; pulsed needs it", required=False, monotone=1),
        "required_optical_power": Range(1e-9, 1e3, "W", "optical power that is needed", monotone=1),
        "rated_optical_power": Range(1e-9, 1e3, "W", "rated optical power", monotone=-1),
        "quality": Choice(QUALITY, "package"),
        "environment": environment_choice(OPTICAL_ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    power: Array,
    package: str,
    current: Array,
    application: str,
    required_optical_power: Array,
    rated_optical_power: Array,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
    duty: Array | None = None,
) -> Factor:
    """λp = λb · πT · πQ · πI · πA · πP · πE

    πI = I^0.68; πA is 4.4, pulsed √duty; πP = 1/(2 · (1 − Pr/Ps)) for Pr/Ps up to 0.95. The junction must be of 25 to
    75 °C. Replace the laser when its light falls to what is needed. The handbook has no default quality.
    """
    amperes = np.abs(current)
    ratio = np.abs(required_optical_power) / np.asarray(rated_optical_power)
    if application == "cw":
        applied = Factor("πA", 4.4, "continuous wave")
    elif duty is None:
        raise ModelError("mil_hdbk_217f.laser_diode: pulsed needs the input 'duty'")
    else:
        share = np.maximum(duty, 0.0)
        applied = Factor("πA", np.sqrt(share), f"pulsed, {span(share)} of the time")
    return (
        Factor("λb", KIND[kind], f"{kind}, failures/10⁶ h")
        * temperature_factor(4635, temperature, power, package, thermal_resistance, coolest=25.0, hottest=75.0)
        * Factor("πI", amperes**0.68, f"{span(amperes)} A forward peak current")
        * applied
        * Factor(
            "πP",
            1 / (2 * (1 - np.minimum(ratio, LARGEST_RATIO))),
            f"required by rated optical power Pr/Ps = {span(ratio)} of at most {LARGEST_RATIO}",
            outside=above(ratio, LARGEST_RATIO),
            beyond=more_than(
                "the required optical power",
                np.abs(required_optical_power),
                f"{LARGEST_RATIO:g} of the rated optical power,",
                LARGEST_RATIO * np.asarray(rated_optical_power),
                "W",
            ),
        )
        * closing(QUALITY, quality, OPTICAL_ENVIRONMENT, environment)
    )
