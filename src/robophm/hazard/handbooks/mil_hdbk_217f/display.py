"""MIL-HDBK-217F(2) §6.12, alphanumeric light-emitting displays:  λp = λb · πT · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    OPTICAL_ENVIRONMENT,
    QUALITY,
    junction_inputs,
    quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE, "6.12", "6-20", "segment: two transcriptions agree, checked against Appendix A; diode array: one alone"
)

KIND = Table("display type λb", SOURCE, """
    segment      0        0.00043  segment display
    diode_array  0.00009  0.00017  diode array display (one transcription; another has the segment's row for it)
""", columns=("of the device", "of a character"))  # fmt: skip

LOGIC_CHIP = Table("display logic chip λb", SOURCE, """
    without  0
    with     0.000043
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "kind of display", aliases={"seven segment": "segment", "dot matrix": "diode_array"}),
        "characters": Range(1.0, 100.0, "", "characters in one sealed package", whole=True, monotone=1),
        "logic_chip": Choice(LOGIC_CHIP, "with or without a logic chip"),
        **junction_inputs(),
        "quality": quality(),
        "environment": environment_choice(OPTICAL_ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    characters: Array,
    logic_chip: str,
    temperature: Array,
    power: Array,
    package: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πQ · πE

    λb = 0.00043 · C of segments, 0.00009 + 0.00017 · C of a diode array (one source), and 0.000043 more with a logic
    chip. No model of liquid crystals. Quality is plastic, the worst, unless stated.
    """
    device, each = KIND.rows[kind]
    return (
        Factor(
            "λb",
            device + each * np.asarray(characters) + LOGIC_CHIP[logic_chip],
            f"{kind}, {span(characters)} characters, {logic_chip} logic chip, failures/10⁶ h",
        )
        * temperature_factor(2790, temperature, power, package, thermal_resistance)
        * closing(QUALITY, quality, OPTICAL_ENVIRONMENT, environment)
    )
