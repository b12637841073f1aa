"""MIL-HDBK-217F Notice 2 §6.4, §6.8 and §6.9, field-effect transistors: by hand, and where there is no model."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

PLAIN = {
    "kind": "MOSFET",
    "application": "switching",
    "temperature": "25 degC",
    "power": "0 W",
    "rated_power": "0.5 W",
    "environment": "GB",
}
GAAS = {
    "frequency": "5 GHz",
    "output_power": "1 W",
    "temperature": "25 degC",
    "power": "0 W",
    "application": "cw",
    "matching": "none",
    "environment": "GB",
}


@pytest.fixture
def fet(section):
    return section("transistor_fet_low_frequency")


@pytest.fixture
def gaas(section):
    return section("transistor_gaas_fet")


@pytest.fixture
def high_frequency(section):
    return section("transistor_fet_high_frequency")


def test_worked_by_hand(fet, gaas, high_frequency):
    """A power MOSFET of 50 W as a switch; a GaAs FET; a JFET of high frequency: TJ = 40 + 0.5 · 70 = 75 °C."""
    heat = {"temperature": "40 degC", "power": "0.5 W", "environment": "GM"}
    inputs = {**PLAIN, **heat, "rated_power": "50 W"}
    pi_t = math.exp(1925 * (1 / 298 - 1 / 348))
    assert fet.rate(inputs) == pytest.approx(0.012 * pi_t * 8 * 8 * 9, rel=1e-14)
    inputs = {"kind": "jfet", **heat}
    assert high_frequency.rate(inputs) == pytest.approx(0.023 * pi_t * 5 * 5, rel=1e-14)
    inputs = {**GAAS, **heat, "frequency": "8000 MHz", "output_power": "2 W"}
    base = 0.0093 * math.exp(0.429 * 8 + 0.486 * 2)
    expected = base * math.exp(4485 * (1 / 298 - 1 / 348)) * 4 * 4 * 5 * 5
    assert gaas.rate(inputs) == pytest.approx(expected, rel=1e-13)


@each_case("application", ["linear", "switching"])
@each_case(
    ("watts", "expected"),
    [(0.1, None), (1.999, None), (2, 2), (4.99, 2), (5, 4), (49.9, 4), (50, 8), (249, 8), (250, 10), (1000, 10)],
)
def test_from_2_watts_on_only_the_power_counts(application, watts, expected, fet):
    """A switch of 50 W at 0.7 would be 11.4 times too low."""
    found = fet.factors({**PLAIN, "application": application, "rated_power": f"{watts} W"})["πA"]
    assert found == (expected or {"linear": 1.5, "switching": 0.7}[application])


def test_the_mosfet_of_high_frequency_is_not_ten_times_worse(high_frequency):
    """The 2020 tool has 0.6 for 0.060."""
    assert high_frequency.factors({**PLAIN_HIGH, "kind": "MOSFET"})["λb"] == 0.060
    assert high_frequency.factors({**PLAIN_HIGH, "kind": "JFET"})["λb"] == 0.023


PLAIN_HIGH = {"kind": "MOSFET", "temperature": "25 degC", "power": "0 W", "environment": "GB"}


@each_case(
    ("gigahertz", "watts", "expected"),
    [
        (1, 0.05, 0.052),
        (10, 0.0999, 0.052),
        (4, 0.1, 0.0093 * math.exp(0.429 * 4 + 0.486 * 0.1)),
        (10, 6, 0.0093 * math.exp(0.429 * 10 + 0.486 * 6)),
    ],
)
def test_the_two_bases_of_gallium_arsenide(gigahertz, watts, expected, gaas):
    found = gaas.factors({**GAAS, "frequency": f"{gigahertz} GHz", "output_power": f"{watts} W"})["λb"]
    assert found == pytest.approx(expected, rel=1e-14)


@each_case(
    ("gigahertz", "watts", "message"),
    [
        (3.9, 0.1, "0.1 W at 3.9 GHz: from 0.1 W on there is no model below 4 GHz: outside"),
        (1, 6, "6 W at 1 GHz: from 0.1 W on there is no model below 4 GHz: outside"),
        (10.1, 0.05, "frequency 10.1 GHz is outside"),
        (0.9, 0.05, "frequency 0.9 GHz is outside"),
        (5, 6.1, "output_power 6.1 W is outside"),
    ],
)
def test_where_gallium_arsenide_has_no_model(gigahertz, watts, message, gaas):
    with pytest.raises(ModelError, match=message):
        gaas.rate({**GAAS, "frequency": f"{gigahertz} GHz", "output_power": f"{watts} W"})


def test_a_missing_model_is_flagged_live(gaas):
    design = gaas.model.settle({**GAAS, "frequency": "2 GHz", "output_power": "0.05 W"})
    value, extrapolated = gaas.model.evaluate({**design, "output_power": np.array([0.05, 0.09, 0.1, 1.0])})
    assert extrapolated.tolist() == [False, False, True, True]
    assert np.all(value > 0)
