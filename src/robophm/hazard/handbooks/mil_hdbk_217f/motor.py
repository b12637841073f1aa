"""MIL-HDBK-217F(2) §12.1, motors below 1 hp (746 W):  λp = λ1/(A · αB) + λ2/(B · αW)   failures/h"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span, steps
from robophm.hazard.handbooks.mil_hdbk_217f._factors import EFFECTIVE_FAILURES
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "12.1",
    "12-1 … 12-3",
    "two transcriptions agree on A, three on λ1 and λ2; B is of one, and gives the worked example",
)

KIND = Table("motor type A and B", SOURCE, """
    electrical_general  1.9   1.1   electrical, general
    sensor              0.48  0.29  sensor
    servo               2.4   1.7   servo
    stepper             11    5.4   stepper
""", columns=("A", "B"))  # fmt: skip

ALIASES = {"general": "electrical_general", "dc": "electrical_general", "brushless": "electrical_general"}


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(KIND, "type of the motor", aliases=ALIASES),
        "temperature": Range(0.0, 140.0, "degC", "ambient temperature", warmth="ambient"),
        "design_life": Range(1.0, 1e6, "h", "life cycle LC: design life or interval of replacement", monotone=1),
    },
)
def hazard_rate(
    kind: str,
    temperature: Array,
    design_life: Array,
) -> Factor:
    """λp = λ1/(A · αB) + λ2/(B · αW)

    Bearings and windings wear out with Weibull characteristic lives αB and αW [h]; this is their mean rate over the
    life cycle, which has to be stated. Bearings last longest near 35 °C. There is no πE and no πQ.
    """
    kelvin = np.maximum(np.asarray(temperature) + 273, 200.0)  # what a broken sensor says
    cold = _power_of_ten(2.534 - 2357 / kelvin)  # np.power takes many times as long as np.exp
    bearing = 1 / (cold + 1 / (_power_of_ten(20 - 4500 / kelvin) + 300))
    winding = _power_of_ten(2.534 - 1.83) / cold  # 10^(2357/T − 1.83)
    a, b = KIND.rows[kind]
    return _wear("1", "A", a, "B", bearing, design_life) + _wear("2", "B", b, "W", winding, design_life)


def _power_of_ten(exponent: Array | float) -> Array:
    return np.asarray(np.exp(np.log(10) * exponent))


def _wear(number: str, letter: str, divisor: float, part: str, life: Array, design_life: Array) -> Factor:
    """λ1/(A · αB) or λ2/(B · αW)."""
    share = np.asarray(design_life) / life
    return (
        Factor(f"λ{number}", steps(EFFECTIVE_FAILURES, share), f"of LC/α{part} = {span(share)}, cumulative failures")
        * Factor(f"1/{letter}", 1 / divisor, f"{letter} = {divisor:g}")
        * Factor(f"1/α{part}", 1 / life, f"α{part} = {span(life)} h, {'bearings' if part == 'B' else 'windings'}")
    )
