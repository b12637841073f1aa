"""MIL-HDBK-217F Notice 2 §6.3, §6.6 and §6.7, bipolar transistors: by hand, and at their limits."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

PLAIN = {
    "application": "linear",
    "temperature": "25 degC",
    "power": "0 W",
    "rated_power": "1 W",
    "voltage": "10 V",
    "rated_voltage": "40 V",
    "environment": "GB",
}
POWER = {
    **PLAIN,
    "frequency": "1 GHz",
    "output_power": "50 W",
    "temperature": "100 degC",
    "metallization": "gold",
    "application": "cw",
    "matching": "none",
    "quality": "JANTX",
}
del POWER["rated_power"]


@pytest.fixture
def transistor(section):
    return section("transistor_bipolar_low_frequency")


@pytest.fixture
def low_noise(section):
    return section("transistor_bipolar_low_noise_high_frequency")


@pytest.fixture
def high_power(section):
    return section("transistor_bipolar_high_power_high_frequency")


def test_worked_by_hand(transistor, low_noise, high_power):
    """TO-92, case at 45 °C, 0.2 W: TJ = 59 °C; 12 of 40 V."""
    heat = {"temperature": "45 degC", "power": "0.2 W", "package": "TO-92", "environment": "GM"}
    volts = {"voltage": "12 V", "rated_voltage": "40 V"}
    pi_t = math.exp(2114 * (1 / 298 - 1 / 332))
    pi_s = 0.045 * math.exp(3.1 * 0.3)
    inputs = {**heat, **volts, "application": "switching", "rated_power": "0.6 W"}
    assert transistor.rate(inputs) == pytest.approx(0.00074 * pi_t * 0.7 * 0.6**0.37 * pi_s * 8 * 9, rel=1e-14)
    inputs = {**heat, **volts, "rated_power": "0.1 W"}
    assert low_noise.rate(inputs) == pytest.approx(0.18 * pi_t * 0.43 * pi_s * 5 * 5, rel=1e-14)
    base = 0.032 * math.exp(0.354 * 2 + 0.00558 * 30)
    for metal, pi_t in (
        ("gold", 2 * (0.5 - 0.35) * math.exp(2903 * (1 / 373 - 1 / 393))),
        ("aluminum", 7.55 * (0.5 - 0.35) * math.exp(5794 * (1 / 373 - 1 / 393))),
    ):
        inputs = {
            "frequency": "2 GHz",
            "output_power": "30 W",
            "voltage": "20 V",
            "rated_voltage": "40 V",
            "temperature": "100 degC",
            "power": "4 W",
            "thermal_resistance": "5 K/W",
            "metallization": metal,
            "application": "pulsed",
            "duty": "20 percent",
            "matching": "input",
            "environment": "GM",
        }
        expected = base * pi_t * (0.06 * 20 + 0.4) * 2 * 5 * 5
        assert high_power.rate(inputs) == pytest.approx(expected, rel=1e-13)


@each_case(("watts", "expected"), [(0.01, 0.43), (0.1, 0.43), (0.11, 0.11**0.37), (100, 100**0.37)])
def test_rated_power(watts, expected, transistor):
    assert transistor.factors(PLAIN, rated_power=watts)["πR"] == pytest.approx(expected, rel=1e-14)


@each_case(("duty", "expected"), [(0.0, 0.46), (0.01, 0.46), (0.02, 0.52), (0.3, 2.2), (0.31, 2.2), (1.0, 2.2)])
def test_pulses_count_from_1_to_30_percent(duty, expected, high_power):
    found = high_power.factors({**POWER, "application": "pulsed", "duty": duty})
    assert found["πA"] == pytest.approx(expected, rel=1e-14)


def test_high_power_up_to_its_very_limits(high_power):
    for frequency, watts in ((1, 600), (2, 300), (3, 200), (4, 100), (5, 50)):
        assert high_power.rate({**POWER, "frequency": f"{frequency} GHz", "output_power": f"{watts} W"}) > 0
    limit = {**POWER, "voltage": "0.55 V", "rated_voltage": "1 V", "power": "0 W", "temperature": "200 degC"}
    assert high_power.rate(limit) > 0
    aluminum = {**POWER, "metallization": "aluminium", "rated_voltage": "1 V"}
    assert high_power.factors({**aluminum, "voltage": "0.4 V"})["πT stress"] == 0.38
    assert high_power.factors({**aluminum, "voltage": "0.5 V"})["πT stress"] == pytest.approx(7.55 * 0.15, rel=1e-14)


def test_continuous_wave_and_what_pulses_need(high_power):
    assert high_power.factors(POWER)["πA"] == 7.6
    with pytest.raises(ModelError, match="pulsed needs the input 'duty'"):
        high_power.rate({**POWER, "application": "pulsed"})


@each_case(
    ("changed", "message"),
    [
        ({"temperature": "99 degC"}, "the junction, at 99 °C, is colder than the handbook's 100 °C: outside"),
        (
            {"temperature": "150 degC", "power": "1 W"},
            "the temperature of the junction 220 °C is more than the handbook's 200 °C: outside",
        ),
        (
            {"voltage": "22.1 V"},
            "the operating voltage 22.1 V is more than 0.55 of the breakdown voltage, 22 V: outside",
        ),
        ({"output_power": "601 W"}, "output_power 601 W is outside"),
        (
            {"output_power": "301 W", "frequency": "1.5 GHz"},
            "the output power 301 W is more than the handbook's at 1.5 GHz, 300 W",
        ),
        (
            {"output_power": "101 W", "frequency": "4 GHz"},
            "the output power 101 W is more than the handbook's at 4 GHz, 100 W",
        ),
        ({"frequency": "100 MHz"}, "frequency 0.1 GHz is outside"),
    ],
)
def test_high_power_has_narrow_limits(changed, message, high_power):
    assert high_power.rate(POWER) > 0
    with pytest.raises(ModelError, match=message):
        high_power.rate({**POWER, **changed})


def test_overstress_is_refused_in_a_design_and_flagged_live(transistor, low_noise):
    for part, inputs in (
        (transistor, PLAIN),
        (low_noise, {key: value for key, value in PLAIN.items() if key != "application"}),
    ):
        with pytest.raises(ModelError, match="the applied voltage 50 V is more than the rated voltage 40 V: outside"):
            part.rate({**inputs, "voltage": "50 V"})
        design = part.model.settle(inputs)
        value, extrapolated = part.model.evaluate({**design, "voltage": np.array([-1.0, 0.0, 40.0, 41.0, 1e5, 1e9])})
        assert extrapolated.tolist() == [True, False, False, True, True, True]
        assert np.all(np.isfinite(value))
        assert np.all(value > 0)


def test_low_noise_ends_at_a_watt_and_has_no_plastic(low_noise):
    plain = {key: value for key, value in PLAIN.items() if key != "application"}
    with pytest.raises(ModelError, match=r"rated_power 1\.1 W is outside"):
        low_noise.rate({**plain, "rated_power": "1.1 W"})
    with pytest.raises(ModelError, match="quality 'plastic' is not one of its choices"):
        low_noise.rate({**plain, "quality": "plastic"})
