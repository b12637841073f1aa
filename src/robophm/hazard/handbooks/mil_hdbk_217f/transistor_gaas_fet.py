"""MIL-HDBK-217F(2) §6.8, gallium arsenide field-effect transistors, 1 to 10 GHz:

λp = λb · πT · πA · πM · πQ · πE   failures/10⁶ h
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, below
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    RF_QUALITY,
    junction_inputs,
    rf_quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "6.8",
    "6-14 … 6-15",
    "two transcriptions agree but on πE of MF, 7.5 or 9, which is unresolved: Notice 1 has revised the page, and "
    "Appendix A, against which it is checked, needs 9",
)

APPLICATION = Table("GaAs transistor application πA", SOURCE, """
    low_power_or_pulsed  1.0  all low power and pulsed
    cw                   4.0  continuous wave, power
""")  # fmt: skip

MATCHING = Table("GaAs transistor matching network πM", SOURCE, """
    input_and_output  1.0
    input             2.0
    none              4.0
""")  # fmt: skip

ENVIRONMENT = Table("GaAs transistor environment πE", SOURCE, """
    GB   1.0
    GF   2.0
    GM   5.0
    NS   4.0
    NU   11.0
    AIC  4.0
    AIF  5.0
    AUC  7.0
    AUF  12.0
    ARW  16.0
    SF   0.5
    MF   7.5  unresolved: one transcription has 9, and Appendix A needs 9
    ML   24.0
    CL   250.0
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "frequency": Range(1.0, 10.0, "GHz", "frequency", monotone=1),
        "output_power": Range(1e-6, 6.0, "W", "average output power"),
        **junction_inputs(),
        "application": Choice(
            APPLICATION,
            "application",
            aliases={"pulsed": "low_power_or_pulsed", "low power": "low_power_or_pulsed", "continuous": "cw"},
        ),
        "matching": Choice(MATCHING, "internal matching network"),
        "quality": rf_quality(),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    frequency: Array,
    output_power: Array,
    temperature: Array,
    power: Array,
    package: str,
    application: str,
    matching: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πA · πM · πQ · πE

    λb is 0.052 below 0.1 W at 1 to 10 GHz, and 0.0093 · exp(0.429 · F + 0.486 · P) from 0.1 to 6 W at 4 to 10 GHz;
    there is no model between. πE of MF is unresolved: two readings of the section have 7.5, a third
    and Appendix A 9. Quality is the handbook's lower unless stated.
    """
    gigahertz, watts = np.asarray(frequency), np.asarray(output_power)
    small = below(watts, 0.1)
    return (
        Factor(
            "λb",
            np.where(small, 0.052, 0.0093 * np.exp(0.429 * gigahertz + 0.486 * watts)),
            f"{span(gigahertz)} GHz, {span(watts)} W (no model from 0.1 W on below 4 GHz), failures/10⁶ h",
            outside=~small & below(gigahertz, 4.0),
            beyond=lambda: f"{span(watts)} W at {span(gigahertz)} GHz: from 0.1 W on there is no model below 4 GHz",
        )
        * temperature_factor(4485, temperature, power, package, thermal_resistance)
        * Factor("πA", APPLICATION[application], APPLICATION.notes[application])
        * Factor("πM", MATCHING[matching], f"matching {matching}")
        * closing(RF_QUALITY, quality, ENVIRONMENT, environment)
    )
