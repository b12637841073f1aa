"""MIL-HDBK-217F(2) §11.2, inductors and coils:  λp = λb · πT · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing
from robophm.hazard.handbooks.mil_hdbk_217f._inductive import ENVIRONMENT, hot_spot_inputs, temperature_factor
from robophm.hazard.model import Array, Choice, Factor, hazard_model

SOURCE = Source(TITLE, "11.2", "11-3", "two transcriptions agree; checked against one value of Appendix A")

KIND = Table("coil type λb", SOURCE, """
    fixed     0.000030  fixed inductor or choke
    variable  0.000050  variable inductor
""")  # fmt: skip

QUALITY = Table("coil quality πQ", SOURCE, """
    S         0.03
    R         0.1
    P         0.3
    M         1.0
    MIL-SPEC  1.0
    lower     3.0
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(
            KIND, "fixed or variable", aliases={"inductor": "fixed", "choke": "fixed", "ferrite bead": "fixed"}
        ),
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

    Quality is lower unless stated. A ferrite bead is taken as a fixed coil, as later practice has it.
    """
    hot_spot = temperature_factor(
        "mil_hdbk_217f.coil",
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
