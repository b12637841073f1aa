"""MIL-HDBK-217F(2) §6.11, detectors, isolators (optocouplers) and emitters:  λp = λb · πT · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    OPTICAL_ENVIRONMENT,
    QUALITY,
    junction_inputs,
    quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, hazard_model

SOURCE = Source(
    TITLE, "6.11", "6-18 … 6-19", "two transcriptions agree; checked against Appendix A, which takes another πE"
)

KIND = Table("optoelectronic device λb", SOURCE, """
    phototransistor                         0.0055
    photodiode                              0.0040
    isolator_photodiode_single              0.0025   optocoupler, photodiode output
    isolator_phototransistor_single         0.013    optocoupler, phototransistor output
    isolator_photodarlington_single         0.013    optocoupler, photodarlington output
    isolator_light_sensitive_resistor_single 0.0064  optocoupler, light-sensitive resistor
    isolator_photodiode_dual                0.0033   dual optocoupler, photodiode output
    isolator_phototransistor_dual           0.017    dual optocoupler, phototransistor output
    isolator_photodarlington_dual           0.017    dual optocoupler, photodarlington output
    isolator_light_sensitive_resistor_dual  0.0086   dual optocoupler, light-sensitive resistor
    ired                                    0.0013   infrared light-emitting diode
    led                                     0.00023  light-emitting diode
""")  # fmt: skip

ALIASES = {
    "optocoupler": "isolator_phototransistor_single",
    "opto-isolator": "isolator_phototransistor_single",
    "optoisolator": "isolator_phototransistor_single",
    "dual optocoupler": "isolator_phototransistor_dual",
    "infrared led": "ired",
    "ir led": "ired",
}


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "kind of device", aliases=ALIASES),
        **junction_inputs(),
        "quality": quality(),
        "environment": environment_choice(OPTICAL_ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    power: Array,
    package: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πQ · πE

    Appendix A of the handbook takes πE of high frequency instead, up to 1.8 times apart.
    Quality is plastic, the worst, unless stated.
    """
    return (
        Factor("λb", KIND[kind], f"{KIND.notes[kind] or kind}, failures/10⁶ h")
        * temperature_factor(2790, temperature, power, package, thermal_resistance)
        * closing(QUALITY, quality, OPTICAL_ENVIRONMENT, environment)
    )
