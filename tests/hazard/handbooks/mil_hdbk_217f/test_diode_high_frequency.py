"""MIL-HDBK-217F Notice 2 §6.2, high-frequency diodes: by hand; Appendix A in test_appendix_a_semiconductors.py."""

import math

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

PLAIN = {
    "kind": "pin",
    "temperature": "25 degC",
    "power": "0 W",
    "rated_power": "1 W",
    "quality": "JANTX",
    "environment": "GB",
}


@pytest.fixture
def diode(section):
    return section("diode_high_frequency")


def test_worked_by_hand(diode):
    """A PIN of 100 W, junction at 75 °C, lower quality, GM."""
    inputs = {**PLAIN, "rated_power": "100 W", "temperature": "75 degC", "quality": "lower", "environment": "GM"}
    expected = 0.0081 * math.exp(2100 * (1 / 298 - 1 / 348)) * (0.326 * math.log(100) - 0.25) * 25 * 5
    assert diode.rate(inputs) == pytest.approx(expected, rel=1e-14)


@each_case(("watts", "expected"), [(0.1, 0.5), (10, 0.5), (10.001, 0.5006), (3000, 2.3601)])
def test_power_of_a_pin_diode(watts, expected, diode):
    assert diode.factors({**PLAIN, "rated_power": f"{watts} W"})["πR"] == pytest.approx(expected, abs=1e-4)
    assert diode.factors({**PLAIN, "kind": "gunn", "rated_power": f"{watts} W"})["πR"] == 1


def test_what_the_handbook_does_not_have(diode):
    with pytest.raises(ModelError, match="no quality 'plastic' for schottky"):
        diode.rate({**PLAIN, "kind": "Schottky", "quality": "plastic"})
    with pytest.raises(ModelError, match="varactor_multiplier is of a varactor, not pin"):
        diode.rate({**PLAIN, "application": "varactor_multiplier"})
    with pytest.raises(ModelError, match="kind pin needs 'rated_power'"):
        diode.rate({key: value for key, value in PLAIN.items() if key != "rated_power"})
    with pytest.raises(ModelError, match="rated_power 3001 W is outside"):
        diode.rate({**PLAIN, "rated_power": "3001 W"})
