"""MIL-HDBK-217F(2) §11.1, transformers:  λp = λb · πT · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._inductive import ENVIRONMENT, hot_spot_inputs, temperature_factor
from robophm.hazard.model import Array, Choice, Factor, hazard_model

SOURCE = Source(
    TITLE, "11.1", "11-1 … 11-2", "πE, πT: two transcriptions agree; λb of audio and power checked against Appendix A"
)

KIND = Table("transformer type λb", SOURCE, """
    flyback                        0.0054  flyback, below 20 V peak to peak
    audio                          0.014   audio
    low_power_pulse                0.022   low power pulse, below 300 W peak
    high_power_pulse_power_filter  0.049   high power pulse from 300 W peak, power transformers and filters
    rf                             0.13    RF
""")  # fmt: skip

QUALITY = Table("transformer quality πQ", SOURCE, """
    MIL-SPEC  1.0
    lower     3.0
""")  # fmt: skip

ALIASES = {
    "power": "high_power_pulse_power_filter",
    "filter": "high_power_pulse_power_filter",
    "high power pulse": "high_power_pulse_power_filter",
    "pulse": "low_power_pulse",
}


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "type of the transformer", aliases=ALIASES),
        **hot_spot_inputs(),
        "quality": Choice(QUALITY, "quality level", default="lower", aliases={"commercial": "lower"}),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    rise_from: str,
    quality: str,
    environment: str,
    temperature_rise: Array | None = None,
    power_loss: Array | None = None,
    case_area: Array | None = None,
    weight: Array | None = None,
    input_power: Array | None = None,
) -> Factor:
    """λp = λb · πT · πQ · πE

    Quality is lower unless stated. A switching transformer has no row here, only a generic rate in Appendix A.
    """
    hot_spot = temperature_factor(
        "mil_hdbk_217f.transformer",
        temperature,
        rise_from,
        temperature_rise=temperature_rise,
        power_loss=power_loss,
        case_area=case_area,
        weight=weight,
        input_power=input_power,
    )
    base = Factor("λb", KIND[kind], f"{KIND.notes[kind]}, failures/10⁶ h")
    return base * hot_spot * closing(QUALITY, quality, ENVIRONMENT, environment)
