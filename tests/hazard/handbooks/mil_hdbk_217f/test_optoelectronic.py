"""MIL-HDBK-217F Notice 2 §6.11 to §6.13, optoelectronics, displays, laser diodes: by hand, at their limits."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

HEAT = {"temperature": "25 degC", "power": "0 W", "environment": "GB"}
DISPLAY = {**HEAT, "kind": "segment", "characters": 7, "logic_chip": "without", "quality": "JANTX"}
LASER = {
    **HEAT,
    "kind": "GaAs_AlGaAs",
    "current": "100 mA",
    "application": "cw",
    "required_optical_power": "5 mW",
    "rated_optical_power": "10 mW",
    "quality": "hermetic",
}


@each_case(("said", "base"), [("led", 0.00023), ("LED", 0.00023), ("optocoupler", 0.013), ("IR LED", 0.0013)])
def test_worked_by_hand(said, base, section):
    """40 mW at 200 °C/W above 40 °C: TJ = 48 °C; plastic, GM."""
    inputs = {
        "kind": said,
        "temperature": "40 degC",
        "power": "40 mW",
        "thermal_resistance": "200 °C/W",
        "environment": "GM",
    }
    expected = base * math.exp(2790 * (1 / 298 - 1 / 321)) * 8 * 8
    assert section("optoelectronic").rate(inputs) == pytest.approx(expected, rel=1e-13)


@each_case(
    ("kind", "logic_chip", "base"),
    [
        ("segment", "without", 0.00043 * 4),
        ("segment", "with", 0.00043 * 4 + 0.000043),
        ("diode_array", "without", 0.00009 + 0.00017 * 4),
        ("diode array", "with", 0.00009 + 0.00017 * 4 + 0.000043),
    ],
)
def test_the_base_of_displays(kind, logic_chip, base, section):
    found = section("display").factors({**DISPLAY, "kind": kind, "logic_chip": logic_chip, "characters": 4})
    assert found["λb"] == pytest.approx(base, rel=1e-14)


def test_a_laser_worked_by_hand(section):
    """Junction at 45 °C, 40 mA, pulses half the time, 3 of 10 mW, uncoated, GM."""
    inputs = {
        **LASER,
        "temperature": "45 degC",
        "current": "40 mA",
        "application": "pulsed",
        "duty": "50 percent",
        "required_optical_power": "3 mW",
        "quality": "nonhermetic_uncoated",
        "environment": "GM",
    }
    pi_t = math.exp(4635 * (1 / 298 - 1 / 318))
    expected = 3.23 * pi_t * 3.3 * 0.04**0.68 * math.sqrt(0.5) / (2 * 0.7) * 8
    assert section("laser_diode").rate(inputs) == pytest.approx(expected, rel=1e-13)
    assert section("laser_diode").factors(LASER)["πA"] == 4.4
    with pytest.raises(ModelError, match="pulsed needs the input 'duty'"):
        section("laser_diode").rate({**LASER, "application": "pulsed"})


@each_case(
    ("changed", "message"),
    [
        ({"power": "1 W"}, "the temperature of the junction 95 °C is more than the handbook's 75 °C: outside"),
        ({"temperature": "20 degC"}, "the junction, at 20 °C, is colder than the handbook's 25 °C: outside"),
        (
            {"required_optical_power": "9.6 mW"},
            "the required optical power 0.0096 W is more than 0.95 of the rated optical power, 0.0095 W",
        ),
        ({"current": "26 A"}, "current 26 A is outside"),
    ],
)
def test_a_laser_has_narrow_limits(changed, message, section):
    with pytest.raises(ModelError, match=message):
        section("laser_diode").rate({**LASER, **changed})


def test_a_laser_up_to_its_very_limits(section):
    limit = {"required_optical_power": "0.95 W", "rated_optical_power": "1 W", "temperature": "75 degC"}
    assert section("laser_diode").factors({**LASER, **limit})["πP"] == pytest.approx(10, rel=1e-12)


def test_a_dying_laser_is_flagged_and_stays_finite(section):
    part = section("laser_diode").model
    value, extrapolated = part.evaluate(
        {**part.settle(LASER), "required_optical_power": np.array([5e-3, 9.6e-3, 0.02])}
    )
    assert extrapolated.tolist() == [False, True, True]
    assert np.all(np.isfinite(value))
    assert np.all(np.diff(value) >= 0)
