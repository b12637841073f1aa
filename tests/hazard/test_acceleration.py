"""Factors of the hazard rate against their closed forms; 1 at the reference stress, exactly."""

import math

import numpy as np
import pytest

from robophm.core.errors import ModelError, PlugError
from robophm.hazard.acceleration import ACCELERATIONS, acceleration_model
from robophm.hazard.handbooks.mil_hdbk_217f import handbook_arrhenius

ARRHENIUS = {"temperature": "60 degC", "activation_energy": "0.7 eV"}


def factor(name, **given):
    model = acceleration_model(name)
    return float(model.evaluate(model.settle(given)).value)


def test_these_are_the_accelerations():
    assert {name: model.name for name, model in ACCELERATIONS.items()} == {"arrhenius": "arrhenius", "q10": "q10"}
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


@pytest.mark.parametrize("name", ACCELERATIONS)
def test_rises_with_temperature_and_flags_what_is_outside(name):
    model = acceleration_model(name)
    design = model.settle(
        {"temperature": "25 degC", **({"activation_energy": "0.7 eV"} if name == "arrhenius" else {})}
    )
    value, extrapolated = model.evaluate({**design, "temperature": np.array([-101.0, -100, 0, 25, 500, 501])})
    assert np.all(np.diff(value) > 0)
    assert extrapolated.tolist() == [True, False, False, False, False, True]
    assert value[3] == 1


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
