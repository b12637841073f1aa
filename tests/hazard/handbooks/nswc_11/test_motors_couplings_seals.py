"""NSWC-11 chapters 3, 14 and 17 by hand, and at their reference points."""

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.core.units import quantity
from robophm.hazard.handbooks.nswc_11 import static_seal

MOTOR = {"service": "uniform", "temperature": "40 degC", "brushes": None}


def test_a_dc_motor_by_hand(part):
    """2.17 + 40 · 0.354 + 2 · 3.2 + 0.001 = 22.7 per 10⁶ h with two brushes at 25 °C."""
    found = part("electric_motor").rate(**{**MOTOR, "kind": "dc", "temperature": "25 degC"}) * 1e6
    assert found == pytest.approx(2.17 + 40 * 2**-1.5 + 6.4 + 0.001, rel=1e-12)
    assert found == pytest.approx(22.7, abs=0.05)


@each_case(
    ("kind", "base", "brushes"),
    [("dc", 2.17, 2), ("bldc", 1.75, 0), ("ac_single_phase", 6.9, 0), ("three phase", 10, 0)],
)
def test_every_kind_of_motor(kind, base, brushes, part):
    """Only motors with brushes have them, and the base counts at every load."""
    for service, factor in (("uniform", 1), ("heavy_impact", 3)):
        found = part("electric_motor").rate(**{**MOTOR, "kind": kind, "service": service}) * 1e6
        assert found == pytest.approx(base * factor + 40 + 3.2 * brushes + 0.001, rel=1e-12)


def test_what_is_stated_per_hour_is_added_as_it_is(part):
    """The 2020 tool divided shaft, bearings and gears by 10⁶ twice."""
    motor = part("electric_motor")
    plain = motor.rate()
    for term in ("shaft_rate", "bearing_rate", "gear_rate", "capacitor_rate"):
        assert motor.rate(**{term: "3 FPMH"}) - plain == pytest.approx(3e-6, rel=1e-9)


def test_the_winding_of_a_motor(part):
    motor = part("electric_motor")
    assert motor.factors(winding_life="50000 h")["λ_WI,B"] == 20
    assert motor.factors(altitude="5300 ft")["C_alt"] == pytest.approx(1.16, rel=1e-12)
    assert motor.factors(altitude="3300 ft")["C_alt"] == pytest.approx(1, rel=1e-12)
    assert motor.factors(kind="ac_single_phase", voltage_deviation=0.1)["C_V"] == pytest.approx(2, rel=1e-12)
    assert motor.factors(kind="ac_polyphase", voltage_unbalance=2.5)["C_V"] == pytest.approx(2, rel=1e-12)
    assert motor.factors(kind="dc", voltage_deviation=0.1, voltage_unbalance=3.0)["C_V"] == 1
    with pytest.raises(ModelError, match="voltage_unbalance 5 percent is outside 0 … 3 percent"):
        motor.inputs(voltage_unbalance="5 %")


def test_a_coupling_by_hand(part):
    own = part("coupling")
    assert own.rate(service="uniform") == pytest.approx(5.501e-6, rel=1e-12)
    assert own.rate(service="heavy_shock", torque="high") == pytest.approx(7.501e-6, rel=1e-12)
    for term in ("gear_rate", "seal_rate"):
        more = own.rate(**{term: "2e-6 1/cycle"}) - own.rate()
        assert more == pytest.approx(2e-6, rel=1e-9)
    assert own.model.unit == "1/cycle"


SEAL = {
    "pressure": "3000 psi", "allowable_leakage": "0.055 inch^3/min", "inner_diameter": "1 inch", "hardness": "0.55 MPa",
    "contact_pressure": "1 MPa", "surface_finish": "0.1 um", "viscosity": "2e-8 lbf*min/inch^2",
    "temperature": "100 degF", "rated_temperature": "118 degF", "filter_size": "10 um", "flow": "1 gallon/min",
    "particles": 1,
}  # fmt: skip


def test_a_seal_at_its_reference(part):
    """2.4 · 1 · 1 · 1.42 · 1 · 0.25 · 1 · 0.5 · 1."""
    assert part("static_seal").rate(**SEAL) * 1e6 == pytest.approx(2.4 * 1.42 * 0.25 * 0.5, rel=1e-9)


@each_case(
    ("given", "symbol", "factor"),
    [
        ({"pressure": "500 psi"}, "C_P", 0.25),
        ({"pressure": "6000 psi"}, "C_P", 4),
        ({"allowable_leakage": "0.5 inch^3/min"}, "C_Q", 0.11),
        ({"allowable_leakage": "0.01 inch^3/min"}, "C_Q", 4.2 - 0.79),
        ({"allowable_leakage": "0 inch^3/min"}, "C_Q", 4.2),
        ({"inner_diameter": "3 inch"}, "C_DL", 3.62),
        ({"hardness": "1.1 MPa"}, "C_H", 2**4.3),
        ({"surface_finish": "32 microinch"}, "C_f", 32**1.65 / 353),
        ({"viscosity": "8e-8 lbf*min/inch^2"}, "C_v", 0.25),
        ({"temperature": "136 degF"}, "C_T", 2),
        ({"temperature": "82 degF"}, "C_T", 0.25),
        ({"temperature": "77 degF"}, "C_T", 0.21),
        ({"filter_size": "20 um"}, "C_N", 8),
        ({"flow": "3 gallon/min"}, "C_N", 3),
    ],
)
def test_factors_of_a_seal_by_hand(given, symbol, factor, part):
    assert part("static_seal").factors(**{**SEAL, **given})[symbol] == pytest.approx(factor, rel=1e-9)


@each_case(
    ("key", "symbol", "at"),
    [
        ("pressure", "C_P", quantity("1500 psi", "MPa")),
        ("allowable_leakage", "C_Q", quantity("0.03 in^3/min", "cm^3/min")),
        ("surface_finish", "C_f", quantity("15 microinch", "um")),
    ],
)
def test_where_a_seals_formula_changes_it_does_not_jump(key, symbol, at, part):
    """But for what the handbook rounds, under 2 %."""
    below, above = (part("static_seal").factors(**{key: at * side})[symbol] for side in (1 - 1e-9, 1 + 1e-9))
    assert below == pytest.approx(above, rel=0.02)


def test_conversions_of_a_seal():
    assert quantity("1 lbf*min/inch^2", "Pa*s") == pytest.approx(static_seal.REYN_MINUTE, rel=1e-12)
    assert quantity("1 inch^3", "cm^3") == pytest.approx(static_seal.CUBIC_INCH, rel=1e-12)
    assert quantity("1 gallon", "L") == pytest.approx(static_seal.GALLON, rel=1e-12)
    assert quantity("2e-8 lbf*min/inch^2", "Pa*s") == pytest.approx(8.27e-3, rel=1e-3)
