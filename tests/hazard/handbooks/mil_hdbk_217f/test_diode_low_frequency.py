"""MIL-HDBK-217F Notice 2 §6.1, low-frequency diodes: by hand, and what each kind needs."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.mil_hdbk_217f.diode_low_frequency import KIND

PLAIN = {
    "kind": "switching",
    "temperature": "25 degC",
    "power": "0 W",
    "voltage": "5 V",
    "rated_voltage": "10 V",
    "junctions": 1,
    "contact": "bonded",
    "environment": "GB",
}


@pytest.fixture
def diode(section):
    return section("diode_low_frequency")


def test_worked_by_hand(diode):
    """Power rectifier in TO-220, case at 50 °C, 2 W, 60 of 100 V, spring, plastic, GM: TJ = 60 °C."""
    inputs = {
        **PLAIN,
        "kind": "Schottky",
        "temperature": "50 degC",
        "power": "2 W",
        "package": "TO-220",
        "voltage": "60 V",
        "rated_voltage": "100 V",
        "contact": "spring",
        "environment": "GM",
    }
    expected = 0.0030 * math.exp(-3091 * (1 / 333 - 1 / 298)) * 0.6**2.43 * 2 * 8 * 9
    assert diode.rate(inputs) == pytest.approx(expected, rel=1e-14)


@each_case(
    ("kind", "coefficient"),
    [
        ("general_purpose_analog", 3091),
        ("switching", 3091),
        ("fast_recovery_power_rectifier", 3091),
        ("power_rectifier_schottky", 3091),
        ("high_voltage_stack", 3091),
        ("transient_suppressor_varistor", 3091),
        ("current_regulator", 1925),
        ("voltage_regulator_zener", 1925),
        ("voltage_reference", 1925),
    ],
)
def test_each_kind_has_its_own_temperature_constant(kind, coefficient, diode):
    """The 2020 tool has the two constants exchanged."""
    found = diode.factors({**PLAIN, "kind": kind}, temperature=100.0)["πT"]
    assert found == pytest.approx(math.exp(coefficient * (1 / 298 - 1 / 373)), rel=1e-14)


def test_a_stack_counts_its_junctions(diode):
    """The 2020 tool forgets them."""
    one, ten = (diode.rate({**PLAIN, "kind": "high_voltage_stack", "junctions": number}) for number in (1, 10))
    assert ten == pytest.approx(10 * one, rel=1e-14)
    assert diode.rate({**PLAIN, "junctions": 10}) == diode.rate(PLAIN)
    rest = {key: value for key, value in PLAIN.items() if key != "junctions"}
    with pytest.raises(ModelError, match="needs its 'junctions'"):
        diode.rate({**rest, "kind": "high_voltage_stack"})


@each_case("kind", KIND)
def test_voltage_counts_where_the_handbook_says_so(kind, diode):
    rest = {key: value for key, value in PLAIN.items() if "voltage" not in key}
    if kind.startswith(("transient", "current_reg", "voltage")):
        assert diode.factors({**rest, "kind": kind})["πS"] == 1
    else:
        with pytest.raises(ModelError, match=f"kind {kind} needs 'voltage' and 'rated_voltage'"):
            diode.rate({**rest, "kind": kind})


@each_case(("volts", "expected"), [(0.0, 0.054), (3.0, 0.054), (3.1, 0.31**2.43), (10.0, 1.0)])
def test_voltage_stress(volts, expected, diode):
    assert diode.factors(PLAIN, voltage=volts)["πS"] == pytest.approx(expected, rel=1e-14)


def test_overstress_and_a_hot_junction_are_refused_in_a_design_and_flagged_live(diode):
    with pytest.raises(ModelError, match="the reverse voltage 12 V is more than the rated voltage 10 V: outside"):
        diode.rate({**PLAIN, "voltage": "12 V"})
    with pytest.raises(
        ModelError, match="the temperature of the junction 195 °C is more than the handbook's 175 °C: outside"
    ):
        diode.rate({**PLAIN, "temperature": "125 degC", "power": "1 W"})
    assert diode.rate({**PLAIN, "temperature": "125 degC", "power": "0.5 W", "thermal_resistance": "100 K/W"}) > 0
    design = diode.model.settle(PLAIN)
    value, extrapolated = diode.model.evaluate({**design, "voltage": np.array([-5.0, 0.0, 3.0, 10.0, 11.0])})
    assert extrapolated.tolist() == [True, False, False, False, True]
    assert np.all(value > 0)
    value, extrapolated = diode.model.evaluate({**design, "temperature": np.array([-300.0, 25.0, 180.0])})
    assert extrapolated.tolist() == [True, False, True]
    assert np.all(value >= 0)
