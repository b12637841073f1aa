"""MIL-HDBK-217F Notice 2 §15.1, connectors: by hand, with the current that warms them."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

CONNECTOR = handbook_model("mil_hdbk_217f.connector")
PLAIN = {
    "style": "circular", "temperature": "25 degC", "current": "0 A", "wire_gauge": "22", "matings": "0 /10^3 h",
    "quality": "MIL-SPEC", "environment": "GB",
}  # fmt: skip


def test_worked_by_hand():
    """Rectangular, 40 °C, 2 A through AWG 22: 0.989 · 2^1.85 °C warmer; 100 matings in 1000 h, lower quality, GM."""
    inputs = CONNECTOR.settle({
        "style": "rectangular", "temperature": "40 degC", "current": "2 A", "wire_gauge": "22",
        "matings": "100 /10^3 h", "environment": "GM",
    })  # fmt: skip
    insert = 40 + 0.989 * 2**1.85
    expected = 0.046 * math.exp(-0.14 / 8.617e-5 * (1 / (insert + 273) - 1 / 298)) * 4 * 2 * 8 * 1e-6
    assert CONNECTOR.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)
    half = CONNECTOR.settle({**inputs, "half": "one half"} | {
        "temperature": "40 degC", "current": "2 A", "matings": "100 /10^3 h"
    })  # fmt: skip
    assert CONNECTOR.evaluate(half).value == pytest.approx(expected / 2, rel=1e-14)


@each_case(("style", "rise"), [("rf-coaxial", 5), ("rf-coaxial-power", 50)])
def test_radio_frequency_inserts_do_not_ask_for_the_current(style, rise, factors):
    inputs = {key: value for key, value in PLAIN.items() if key not in ("current", "wire_gauge")}
    found = factors(CONNECTOR, CONNECTOR.settle({**inputs, "style": style}))
    with_current = factors(CONNECTOR, CONNECTOR.settle({**PLAIN, "style": style, "current": "20 A"}))
    warmer = factors(CONNECTOR, CONNECTOR.settle({**PLAIN, "temperature": f"{25 + rise} degC"}))
    assert found["πT"] == with_current["πT"] == warmer["πT"]


@each_case("missing", ["current", "wire_gauge"])
def test_the_current_counts_or_there_is_no_answer(missing):
    """The 2020 tool left the temperature rise of the insert out."""
    with pytest.raises(ModelError, match="style circular needs 'current'"):
        CONNECTOR.settle({key: value for key, value in PLAIN.items() if key != missing})
    with pytest.raises(ModelError, match="wire_gauge '26' is not one of its choices"):
        CONNECTOR.settle({**PLAIN, "wire_gauge": "26"})


@each_case(("matings", "printed"), [(0, 1), (0.05, 1), (0.051, 1.5), (0.5, 1.5), (5, 2), (50, 3), (50.1, 4), (1e4, 4)])
def test_matings(matings, printed, factors):
    assert factors(CONNECTOR, CONNECTOR.settle({**PLAIN, "matings": f"{matings} /10^3 h"}))["πK"] == printed


def test_an_insert_beyond_the_printed_temperatures():
    with pytest.raises(
        ModelError, match=r"the temperature of the insert .* °C is more than the handbook's 250 °C: outside"
    ):
        CONNECTOR.settle({**PLAIN, "temperature": "100 degC", "current": "20 A"})
    design = CONNECTOR.settle(PLAIN)
    value, extrapolated = CONNECTOR.evaluate({**design, "current": np.array([-20.0, 0.0, 5.0, 20.0])})
    assert extrapolated.tolist() == [True, False, False, True]
    assert value[0] == value[3]
