"""MIL-HDBK-217F Notice 2 §6.5 and §6.10, unijunction transistors and thyristors: by hand."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

HEAT = {"temperature": "45 degC", "power": "1 W", "package": "TO-220", "environment": "GM"}
PLAIN = {**HEAT, "rated_current": "4 A", "voltage": "24 V", "rated_voltage": "40 V"}


def test_worked_by_hand(section):
    """TJ = 45 + 5 · 1 = 50 °C; 4 A, 24 of 40 V, plastic, GM."""
    thyristor = 0.0022 * math.exp(3082 * (1 / 298 - 1 / 323)) * 4**0.4 * 0.6**1.9 * 8 * 9
    assert section("thyristor").rate(PLAIN) == pytest.approx(thyristor, rel=1e-13)
    unijunction = 0.0083 * math.exp(2483 * (1 / 298 - 1 / 323)) * 8 * 9
    assert section("transistor_unijunction").rate(HEAT) == pytest.approx(unijunction, rel=1e-13)


@each_case(("stress", "expected"), [(0.0, 0.1), (0.3, 0.1), (0.31, 0.31**1.9), (1.0, 1.0)])
def test_voltage_stress(stress, expected, section):
    assert section("thyristor").factors(PLAIN, voltage=40 * stress)["πS"] == pytest.approx(expected, rel=1e-14)


def test_overstress_is_refused_in_a_design_and_flagged_live(section):
    part = section("thyristor")
    with pytest.raises(ModelError, match=r"the applied voltage .* V is more than the rated voltage .* V: outside"):
        part.rate({**PLAIN, "voltage": "60 V"})
    value, extrapolated = part.model.evaluate({**part.model.settle(PLAIN), "voltage": np.array([-1.0, 40.0, 41.0])})
    assert extrapolated.tolist() == [True, False, True]
    assert np.all(value > 0)
