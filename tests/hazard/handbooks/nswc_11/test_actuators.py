"""NSWC-11 chapter 9: in units of psi, against contact mechanics and by hand."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

STEEL = {
    "cylinder_modulus": "30e6 psi", "cylinder_poisson": 0.3, "piston_modulus": "30e6 psi", "piston_poisson": 0.3,
    "bore": "2.02 inch", "piston_diameter": "2 inch", "wear": "adhesive_prone", "material": "other",
    "yield_strength": "50000 psi", "particle_hardness": 200, "cylinder_hardness": 200, "filter_size": "10 um",
    "temperature": "25.2 degC",
}  # fmt: skip
K = 2 * (1 - 0.3**2) / 30e6
CURVATURE = 0.02 / (2.02 * 2)


def test_side_load_by_hand(part):
    stress = math.sqrt(1000 / 3 * CURVATURE / K)
    expected = 1 / 15.4e3 * (stress / (0.2 * 50e3)) ** 9
    found = part("actuator_side_load").rate(**STEEL, load="1000 lbf", contact_length="3 inch")
    assert found == pytest.approx(expected, rel=1e-9)


def test_axial_load_by_hand(part):
    stress = (1000 * CURVATURE**2 / K**2) ** (1 / 3)
    expected = 1 / 17.7e3 * (stress / (0.2 * 50e3)) ** 9
    assert part("actuator_axial_load").rate(**STEEL, load="1000 lbf") == pytest.approx(expected, rel=1e-9)


def test_against_contact_mechanics(part):
    """Hertz's largest pressure S_C in N_O = 2000 (γ F_Y/S_C)⁹. Of the axial load the constant is not what follows."""
    relative = 2 * CURVATURE
    line = math.sqrt(1000 / 3 * relative / (math.pi * K))
    side = part("actuator_side_load").rate(**STEEL, load="1000 lbf", contact_length="3 inch")
    assert side == pytest.approx((line / 10e3) ** 9 / 2000, rel=0.02)
    point = (6 * 1000 * relative**2 / K**2 / math.pi**3) ** (1 / 3)
    axial = part("actuator_axial_load").rate(**STEEL, load="1000 lbf")
    assert (point / 10e3) ** 9 / 2000 / axial == pytest.approx(17.7 / 4.3, rel=0.02)
    assert "unverified" in part("actuator_axial_load").model.source.status


@each_case(("name", "load"), [("actuator_side_load", 4.5), ("actuator_axial_load", 3.0)])
def test_powers(name, load, part):
    actuator = part(name)
    settled = actuator.inputs()
    for key, power in {"load": load, "yield_strength": -9, "particle_hardness": 1, "filter_size": 1}.items():
        once, twice = (actuator.model.evaluate({**settled, key: settled[key] * times}).value for times in (1, 2))
        assert twice / once == pytest.approx(2.0**power, rel=1e-12), key


@each_case("name", ["actuator_side_load", "actuator_axial_load"])
def test_both_materials_give_way(name, part):
    """The 2020 tool took the difference of the elastic terms, so that equal materials lasted for ever or not at all."""
    actuator = part(name)
    equal = actuator.rate(cylinder_modulus="200 GPa", piston_modulus="200 GPa")
    stiffer = actuator.rate(cylinder_modulus="200 GPa", piston_modulus="400 GPa")
    swapped = actuator.rate(cylinder_modulus="400 GPa", piston_modulus="200 GPa")
    assert 0 < equal < stiffer < math.inf
    assert stiffer == pytest.approx(swapped, rel=1e-12)


@each_case(("celsius", "factor"), [(25.2, 1), (100, math.exp(1200 * (1 / 298.2 - 1 / 373)))])
def test_heat_is_of_kelvins(celsius, factor, part):
    """The 2020 tool divided by degrees Celsius."""
    assert part("actuator_axial_load").factors(temperature=float(celsius))["C_T"] == pytest.approx(factor, rel=1e-12)


def test_it_counts_cycles(part):
    for name in ("actuator_side_load", "actuator_axial_load"):
        assert part(name).model.unit == "1/cycle"


def test_a_piston_wider_than_its_bore_does_not_go_in(part):
    actuator = part("actuator_axial_load")
    with pytest.raises(ModelError, match="the piston's diameter is not smaller than the cylinder's bore"):
        actuator.inputs(bore="50 mm", piston_diameter="50 mm")
    value, extrapolated = actuator.model.evaluate({**actuator.inputs(), "bore": np.array([49.0, 50.0, 50.1])})
    assert extrapolated.tolist() == [True, True, False]
    assert value.tolist()[:2] == [0, 0]


def test_of_a_range_of_yield_strengths_the_lower_end_counts(part):
    actuator = part("actuator_axial_load")
    by_table = actuator.rate(material="stainless", yield_strength=None)
    assert by_table == pytest.approx(actuator.rate(material="other", yield_strength="50000 psi"), rel=1e-12)
    with pytest.raises(ModelError, match="other yield strength needs 'yield_strength'"):
        actuator.inputs(material="other", yield_strength=None)
