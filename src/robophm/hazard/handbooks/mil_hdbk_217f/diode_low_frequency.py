"""MIL-HDBK-217F(2) §6.1, low-frequency diodes:  λp = λb · πT · πS · πC · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing, stress_ratio
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    ENVIRONMENT,
    QUALITY,
    junction_inputs,
    quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(TITLE, "6.1", "6-2 … 6-3", "two transcriptions agree; five types checked against Appendix A")

KIND = Table("diode type", SOURCE, """
    general_purpose_analog         0.0038  3091 1  general purpose, analog
    switching                      0.0010  3091 1  switching
    fast_recovery_power_rectifier  0.025   3091 1  power rectifier, fast recovery (0.069 before Notice 2)
    power_rectifier_schottky       0.0030  3091 1  power rectifier, Schottky power diode
    high_voltage_stack             0.0050  3091 1  power rectifier, high-voltage stack: per junction
    transient_suppressor_varistor  0.0013  3091 0  transient suppressor, varistor
    current_regulator              0.0034  1925 0  current regulator
    voltage_regulator_zener        0.0020  1925 0  voltage regulator, avalanche and Zener
    voltage_reference              0.0020  1925 0  voltage reference, avalanche and Zener
""", columns=("λb", "B", "πS applies"))  # fmt: skip

CONTACT = Table("diode contact construction πC", SOURCE, """
    bonded  1.0  metallurgically bonded
    spring  2.0  not metallurgically bonded, spring-loaded contacts
""")  # fmt: skip

ALIASES = {
    "general purpose": "general_purpose_analog",
    "signal": "switching",
    "small signal": "switching",
    "fast recovery": "fast_recovery_power_rectifier",
    "rectifier": "power_rectifier_schottky",
    "power rectifier": "power_rectifier_schottky",
    "schottky": "power_rectifier_schottky",
    "tvs": "transient_suppressor_varistor",
    "transient suppressor": "transient_suppressor_varistor",
    "varistor": "transient_suppressor_varistor",
    "mov": "transient_suppressor_varistor",
    "zener": "voltage_regulator_zener",
}


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "type and application of the diode", aliases=ALIASES),
        **junction_inputs(),
        "voltage": Range(0.0, 1e5, "V", "reverse voltage; not for suppressors, regulators, references", required=False),
        "rated_voltage": Range(1e-3, 1e5, "V", "rated reverse voltage; as voltage", required=False),
        "contact": Choice(CONTACT, "contact construction"),
        "junctions": Range(
            1.0, 1e3, "", "junctions of a high-voltage stack; it needs it", whole=True, required=False, monotone=1
        ),
        "quality": quality(),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    power: Array,
    package: str,
    contact: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
    voltage: Array | None = None,
    rated_voltage: Array | None = None,
    junctions: Array | None = None,
) -> Factor:
    """λp = λb · πT · πS · πC · πQ · πE

    πS is 0.054 up to S = 0.3 and S^2.43 above, 1 for suppressors, regulators and references. Quality is plastic, the
    worst, unless stated.
    """
    base: Array | float = KIND[kind]
    if kind == "high_voltage_stack":
        if junctions is None:
            raise ModelError("mil_hdbk_217f.diode_low_frequency: a high_voltage_stack needs its 'junctions'")
        base = base * np.asarray(junctions)
    if not KIND.cell(kind, "πS applies"):
        stressed = Factor("πS", 1.0, f"1 for a {kind}")
    elif voltage is None or rated_voltage is None:
        raise ModelError(f"mil_hdbk_217f.diode_low_frequency: kind {kind} needs 'voltage' and 'rated_voltage'")
    else:
        stress = stress_ratio(voltage, rated_voltage)
        stressed = Factor(
            "πS",
            np.where(above(stress, 0.3), stress**2.43, 0.054),
            f"reverse voltage stress S = {span(stress)} of at most 1",
            outside=above(stress, 1.0),
            beyond=more_than("the reverse voltage", np.abs(voltage), "the rated voltage", rated_voltage, "V"),
        )
    return (
        Factor("λb", base, f"{KIND.notes[kind]}, failures/10⁶ h")
        * temperature_factor(KIND.cell(kind, "B"), temperature, power, package, thermal_resistance)
        * stressed
        * Factor("πC", CONTACT[contact], CONTACT.notes[contact])
        * closing(QUALITY, quality, ENVIRONMENT, environment)
    )
