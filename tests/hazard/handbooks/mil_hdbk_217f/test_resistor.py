"""MIL-HDBK-217F Notice 2 §9.1, resistors: by hand, and what each style has."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

PLAIN = {"style": "RM", "temperature": "25 degC", "power": "1 W", "rated_power": "2 W", "environment": "GB"}


def test_worked_by_hand(section):
    """RM, 40 °C, 10 mW of 100 mW, commercial, GM: 0.0037 · πT · 0.01^0.39 · 0.71 exp(0.11) · 10 · 16."""
    inputs = {**PLAIN, "temperature": "40 degC", "power": "10 mW", "rated_power": "100 mW", "environment": "GM"}
    pi_t = math.exp(0.08 / 8.617e-5 * (1 / 298 - 1 / 313))
    expected = 0.0037 * pi_t * 0.01**0.39 * 0.71 * math.exp(0.11) * 10 * 16
    assert section("resistor").rate(inputs) == pytest.approx(expected, rel=1e-14)


@each_case(("style", "ones"), [("RD", {"πT"}), ("RZ", {"πS"}), ("RTH", {"πT", "πS"})])
def test_factors_that_a_style_has_not(style, ones, section):
    found = section("resistor").factors({**PLAIN, "style": style, "temperature": "100 degC"})
    assert {symbol for symbol in ("πT", "πS", "πP") if found[symbol] == 1} == ones | {"πP"}  # 1 W


def test_overstress_is_refused_in_a_design_and_flagged_live(section):
    resistor = section("resistor").model
    with pytest.raises(ModelError, match=r"the power dissipated .* W is more than the rated power .* W: outside"):
        resistor.settle({**PLAIN, "power": "3 W"})
    value, extrapolated = resistor.evaluate({**resistor.settle(PLAIN), "power": np.array([-1.0, 1.0, 2.0, 2.1, 1e4])})
    assert extrapolated.tolist() == [True, False, False, True, True]
    assert np.all(np.isfinite(value))
    assert np.all(value > 0)


@each_case(
    ("said", "style"),
    [("chip resistor", "RM"), ("Chip", "RM"), ("NTC", "RTH"), ("trimpot", "RJ"), ("Metal Film", "RN"), ("RCR", "RCR")],
)
def test_names_that_people_use(said, style, section):
    assert section("resistor").model.settle({**PLAIN, "style": said})["style"] == style
