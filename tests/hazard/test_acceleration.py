"""Factors of the hazard rate against their closed forms; 1 at the reference stress, exactly."""

import math
from decimal import Decimal, getcontext

import numpy as np
import pytest

from robophm.core.errors import ModelError, PlugError
from robophm.hazard.acceleration import ACCELERATIONS, acceleration_model, stress_inputs
from robophm.hazard.handbooks.mil_hdbk_217f import handbook_arrhenius

ARRHENIUS = {"temperature": "60 degC", "activation_energy": "0.7 eV"}


def factor(name, **given):
    model = acceleration_model(name)
    return float(model.evaluate(model.settle(given)).value)


def test_these_are_the_accelerations():
    assert {name: model.name for name, model in ACCELERATIONS.items()} == {
        "arrhenius": "arrhenius",
        "eyring": "eyring",
        "q10": "q10",
        "peck": "peck",
        "coffin_manson": "coffin_manson",
        "cubic_load": "cubic_load",
        "inverse_power": "inverse_power",
    }
    with pytest.raises(PlugError, match="no acceleration 'arhenius'; did you mean 'arrhenius'"):
        acceleration_model("arhenius")


@pytest.mark.parametrize("reference", [-40.0, 25.0, 85.0])
def test_one_at_the_reference(reference):
    at = {"temperature": f"{reference} degC", "reference_temperature": f"{reference} degC"}
    assert factor("arrhenius", **at, activation_energy="0.7 eV") == 1
    assert factor("q10", **at) == 1
    assert factor("q10", **at, q=3.5) == 1


def test_arrhenius_closed_form():
    expected = math.exp(0.7 / 8.617333e-5 * (1 / 298.15 - 1 / 333.15))
    assert factor("arrhenius", **ARRHENIUS) == pytest.approx(expected, rel=1e-14)
    assert expected == pytest.approx(17.5, abs=0.1)  # 0.7 eV from 25 to 60 °C: about 17, as textbooks have it


def test_arrhenius_of_a_published_example():
    """NIST/SEMATECH e-Handbook 8.1.5.1: Ea = 0.5 eV from 25 to 125 °C is a factor of about 133."""
    assert factor("arrhenius", temperature="125 degC", activation_energy="0.5 eV") == pytest.approx(133, rel=0.01)


@pytest.mark.parametrize(
    ("temperature", "q", "expected"),
    [("25 degC", 2, 1), ("35 degC", 2, 2), ("15 degC", 2, 0.5), ("60 degC", 2, 2**3.5), ("45 degC", 3, 9)],
)
def test_q10_closed_form(temperature, q, expected):
    assert factor("q10", temperature=temperature, q=q) == pytest.approx(expected, rel=1e-14)


def test_the_handbook_and_the_physical_arrhenius_differ():
    physical = factor("arrhenius", temperature="100 degC", activation_energy="0.35 eV")
    rounded = float(handbook_arrhenius(100.0, 0.35))
    assert physical != rounded
    assert physical == pytest.approx(rounded, rel=5e-3)


@pytest.mark.parametrize("name", ["arrhenius", "q10"])
def test_rises_with_temperature_and_flags_what_is_outside(name):
    model = acceleration_model(name)
    design = model.settle(
        {"temperature": "25 degC", **({"activation_energy": "0.7 eV"} if name == "arrhenius" else {})}
    )
    value, extrapolated = model.evaluate({**design, "temperature": np.array([-101.0, -100, 0, 25, 500, 501])})
    assert np.all(np.diff(value) > 0)
    assert extrapolated.tolist() == [True, False, False, False, False, True]
    assert value[3] == 1


def test_laws_of_load_and_voltage():
    assert factor("cubic_load", load=1.5) == pytest.approx(3.375, rel=1e-15)
    assert factor("cubic_load", load=0.5, reference_load=0.25) == pytest.approx(8, rel=1e-15)
    assert factor("cubic_load", load=0) == 0
    at = {"voltage": "12 V", "reference_voltage": "24 V"}
    assert factor("inverse_power", **at, exponent=5) == pytest.approx(1 / 32, rel=1e-15)


def test_a_load_and_its_opposite_count_alike():
    model = acceleration_model("cubic_load")
    value, extrapolated = model.evaluate({**model.settle({"load": 1}), "load": np.array([-2.0, 2.0, 101.0])})
    assert value.tolist() == [8, 8, pytest.approx(101**3)]
    assert extrapolated.tolist() == [False, False, True]


def test_below_absolute_zero_nothing_turns_over():
    model = acceleration_model("arrhenius")
    design = model.settle(ARRHENIUS)
    value, extrapolated = model.evaluate({**design, "temperature": np.array([-1e6, -274.0, -273.15, -273.0, -200.0])})
    assert np.all(np.diff(value) >= 0)
    assert np.all(value < 1)
    assert np.all(extrapolated)


def test_inputs_that_are_not_taken():
    with pytest.raises(ModelError, match=r"^arrhenius needs the input 'activation_energy' \(0 … 5 eV\)$"):
        factor("arrhenius", temperature="60 degC")
    with pytest.raises(ModelError, match=r"^q10 has no input 'Q'; did you mean 'q'\?"):
        factor("q10", temperature="60 degC", Q=2)
    with pytest.raises(ModelError, match=r"^q10: q 0\.5 is outside 1 … 10$"):
        factor("q10", temperature="60 degC", q=0.5)


def by_decimals(activation_energy, reference, temperature):
    """Arrhenius in 40 decimals."""
    getcontext().prec = 40
    kelvin = [Decimal(str(t)) + Decimal("273.15") for t in (reference, temperature)]
    return (Decimal(str(activation_energy)) / Decimal("8.617333e-5") * (1 / kelvin[0] - 1 / kelvin[1])).exp()


@pytest.mark.parametrize("exponent", [0, 1, 2.5])
@pytest.mark.parametrize("temperature", [-40, 25, 60, 150])
def test_eyring_is_arrhenius_and_a_power_of_the_kelvins(temperature, exponent):
    found = factor("eyring", temperature=f"{temperature} degC", activation_energy="0.7 eV", exponent=exponent)
    kelvins = (Decimal(temperature) + Decimal("273.15")) / Decimal("298.15")
    assert found == pytest.approx(float(by_decimals(0.7, 25, temperature) * kelvins ** Decimal(exponent)), rel=1e-13)


def test_eyring_without_its_power_is_arrhenius():
    assert factor("eyring", **ARRHENIUS, exponent=0) == factor("arrhenius", **ARRHENIUS)
    assert factor("eyring", **ARRHENIUS) == pytest.approx(factor("arrhenius", **ARRHENIUS) * 333.15 / 298.15, rel=1e-15)


def test_peck_closed_form():
    """From 25 degC, 50 % to the standard test at 85 degC, 85 %: n = 3 and 0.9 eV (Hallberg and Peck 1991)."""
    at = {"humidity": "85 %", "reference_humidity": "50 %", "temperature": "85 degC"}
    expected = (Decimal(85) / 50) ** 3 * by_decimals(0.9, 25, 85)
    assert factor("peck", **at, exponent=3, activation_energy="0.9 eV") == pytest.approx(float(expected), rel=1e-13)
    default = (Decimal(85) / 50) ** Decimal("2.66") * by_decimals(0.79, 25, 85)
    assert factor("peck", **at) == pytest.approx(float(default), rel=1e-13)


def test_peck_is_a_power_of_humidity_and_of_nothing_else_at_the_reference_temperature():
    at = {"reference_humidity": "40 percent", "temperature": "25 degC"}
    assert factor("peck", **at, humidity="80 percent") == pytest.approx(2**2.66, rel=1e-15)
    assert factor("peck", **at, humidity="40 percent") == 1
    assert factor("peck", **at, humidity="0 percent") == 0
    assert factor("peck", **at, humidity="80 percent", exponent=0) == 1


@pytest.mark.parametrize(
    ("swing", "exponent", "expected"), [(80, 2, 4), (40, 2, 1), (20, 4, 1 / 16), (120, 1.9, 3**1.9)]
)
def test_coffin_manson_closed_form(swing, exponent, expected):
    at = {"temperature_swing": f"{swing} K", "reference_temperature_swing": "40 delta_degC", "exponent": exponent}
    assert factor("coffin_manson", **at) == pytest.approx(expected, rel=1e-15)


def test_what_is_measured_of_each():
    assert {name: stress_inputs(model) for name, model in ACCELERATIONS.items()} == {
        "arrhenius": ("temperature",),
        "eyring": ("temperature",),
        "q10": ("temperature",),
        "peck": ("humidity", "temperature"),
        "coffin_manson": ("temperature_swing",),
        "cubic_load": ("load",),
        "inverse_power": ("voltage",),
    }


GIVEN = {
    "arrhenius": ARRHENIUS,
    "eyring": ARRHENIUS,
    "q10": {"temperature": "25 degC"},
    "peck": {"humidity": "50 %", "reference_humidity": "50 %", "temperature": "25 degC"},
    "coffin_manson": {"temperature_swing": "40 K", "reference_temperature_swing": "40 K", "exponent": 2},
    "cubic_load": {"load": 1},
    "inverse_power": {"voltage": "5 V", "reference_voltage": "5 V", "exponent": 3},
}


@pytest.mark.parametrize("name", ACCELERATIONS)
def test_more_stress_never_helps_and_arrays_are_scalars_side_by_side(name):
    model = acceleration_model(name)
    design = model.settle(GIVEN[name])
    for key in stress_inputs(model):
        entry = model.numbers[key]
        values = np.linspace(max(entry.low, 0.0 if key in ("load", "voltage") else -np.inf), entry.high, 300)
        value, extrapolated = model.evaluate({**design, key: values})
        assert value.shape == (300,)
        assert not extrapolated.any()
        assert np.all(np.diff(value) > 0)
        assert value[::50].tolist() == [float(model.evaluate({**design, key: one}).value) for one in values[::50]]


@pytest.mark.parametrize("name", ACCELERATIONS)
def test_a_broken_sensor_gives_no_negative_or_infinite_factor(name):
    model = acceleration_model(name)
    design = model.settle(GIVEN[name])
    for key in stress_inputs(model):
        entry = model.numbers[key]
        broken = np.array([-2e3, entry.low - 1, entry.high + 1, 2e3])
        broken = broken[(broken < entry.low) | (broken > entry.high)]
        value, extrapolated = model.evaluate({**design, key: broken})
        assert np.all(value >= 0)
        assert np.all(np.isfinite(value))
        assert extrapolated.all()
