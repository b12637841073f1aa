"""NSWC-11 chapter 4: at the reference every factor is 1 and λ is the printed base rate; elsewhere by hand."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.nswc_11._spring import MATERIAL, STRENGTH

COMMON = {"alloy": "other", "tensile_strength": "190000 psi", "cycle_rate": "300 cycle/min", "material": "other"}
SHEAR = {**COMMON, "shear_modulus": "11.5e6 psi"}
ELASTIC = {**COMMON, "elastic_modulus": "28.5e6 psi"}
COIL = {"wire_diameter": "0.085 inch", "coil_diameter": "0.58 inch", "active_coils": 14}
BENT = {"thickness": "0.025 inch", "deflection": "0.055 inch"}
REFERENCE = {
    "helical_spring": (23.8, {**SHEAR, **COIL, "deflection": "1.07 inch"}),
    "torsion_spring": (14.3, {**ELASTIC, **COIL, "angle": "0.667 turn"}),
    "curved_washer": (1.1, {**ELASTIC, **BENT, "outer_diameter": "1.2 inch"}),
    "wave_washer": (1.9, {**ELASTIC, **BENT, "outer_diameter": "1.2 inch", "waves": 5}),
    "cantilever_spring": (1.1, {**ELASTIC, **BENT, "span": "1.2 inch"}),
    "beam_spring": (4.4, {**ELASTIC, **BENT, "span": "1.2 inch"}),
}
POWERS = {
    "helical_spring": {"shear_modulus": 3, "active_coils": -3, "deflection": 3},
    "torsion_spring": {"elastic_modulus": 3, "wire_diameter": 3, "active_coils": -3, "angle": 3, "coil_diameter": -3},
    "curved_washer": {"elastic_modulus": 3, "thickness": 3, "outer_diameter": -6, "deflection": 3},
    "wave_washer": {"thickness": 3, "outer_diameter": -6, "deflection": 3, "waves": -2},
    "belleville_washer": {"elastic_modulus": 3, "thickness": 3, "deflection": 3},
    "cantilever_spring": {"elastic_modulus": 3, "thickness": 3, "span": -6, "deflection": 3},
    "beam_spring": {"elastic_modulus": 3, "thickness": 3, "span": -6, "deflection": 3},
}


@each_case("name", REFERENCE)
def test_the_base_rate_at_the_reference(name, part):
    base, inputs = REFERENCE[name]
    # K_W is 1.219 in print, at r = 0.58/0.085; hence C_K is 1 to a thousandth
    assert part(name).rate(**inputs) * 1e6 == pytest.approx(base, rel=1e-3 if name == "helical_spring" else 1e-9)


@each_case(("name", "key", "power"), [(n, k, p) for n, powers in POWERS.items() for k, p in powers.items()])
def test_powers(name, key, power, part):
    """Twice an input is 2^power times the rate."""
    spring = part(name)
    settled = spring.inputs()
    once, twice = (spring.model.evaluate({**settled, key: settled[key] * times}).value for times in (1, 2))
    assert twice / once == pytest.approx(2.0**power, rel=1e-12)


@each_case("name", POWERS)
def test_strength_and_cycles_count_in_every_spring(name, part):
    spring = part(name)
    rate = spring.rate(tensile_strength="1000 MPa", cycle_rate="20 cycle/min")
    assert spring.rate(tensile_strength="2000 MPa", cycle_rate="20 cycle/min") == pytest.approx(rate / 8, rel=1e-12)
    for per_minute, factor in ((0, 0.1), (30, 0.1), (150, 0.5), (300, 1.0), (600, 8.0), (3000, 1000.0)):
        found = spring.rate(tensile_strength="1000 MPa", cycle_rate=f"{per_minute} cycle/min")
        assert found / rate == pytest.approx(factor / 0.1, rel=1e-12)
    assert spring.rate(corrosion=2, manufacture=1.5) == pytest.approx(3 * spring.rate(), rel=1e-12)


@each_case(("index", "wahl"), [(2, 2.058), (4, 1.404), (6.82, 1.219), (10, 1.145), (20, 1.070)])
def test_wahls_factor(index, wahl, part):
    """Wahl's factor as tabled in machine design; the 2020 tool had 4r + 1 for 4r − 4."""
    found = part("helical_spring").factors(wire_diameter=1.0, coil_diameter=float(index))["C_K"]
    assert found == pytest.approx((wahl / 1.219) ** 3, rel=2e-3)


def test_a_coil_no_wider_than_its_wire_is_no_spring(part):
    spring = part("helical_spring")
    with pytest.raises(
        ModelError, match="the coil's diameter is not larger than the wire's: outside the handbook's range"
    ):
        spring.inputs(wire_diameter="5 mm", coil_diameter="5 mm")
    value, extrapolated = spring.model.evaluate({**spring.inputs(), "coil_diameter": np.array([1.0, 2.0, 2.01])})
    assert extrapolated.tolist() == [True, True, False]
    assert np.all(np.isfinite(value))


@each_case("ratio", [1.2, 1.5, 2.0, 3.0, 5.0])
def test_belleville_is_the_product_of_almen_and_laszlos_constants(ratio, part):
    log = math.log(ratio)
    M = 6 / (math.pi * log) * ((ratio - 1) / ratio) ** 2
    C1 = 6 / (math.pi * log) * ((ratio - 1) / log - 1)
    C2 = 6 / (math.pi * log) * (ratio - 1) / 2
    inputs = {**ELASTIC, **BENT, "outer_diameter": "1.2 inch", "inner_diameter": f"{1.2 / ratio} inch"}
    assert part("belleville_washer").rate(**inputs) * 1e6 == pytest.approx(2.6 * M * C1 * C2, rel=1e-9)


def test_a_ring_without_a_width_is_no_washer(part):
    with pytest.raises(ModelError, match="the outer diameter is not larger than the inner one: outside"):
        part("belleville_washer").inputs(outer_diameter="10 mm", inner_diameter="10 mm")


def test_si_and_inches_are_one(part):
    """Converted by hand: 0.1 in is 2.54 mm, 10⁶ psi is 6.894757 GPa."""
    spring = part("helical_spring")
    si = spring.rate(
        wire_diameter="2.54 mm", coil_diameter="25.4 mm", deflection="12.7 mm", shear_modulus="79.28971 GPa"
    )
    inches = spring.rate(wire_diameter="0.1 in", coil_diameter="1 in", deflection="0.5 in", shear_modulus="11.5e6 psi")
    assert si == pytest.approx(inches, rel=1e-6)


def test_what_no_table_has_is_stated(part):
    spring = part("helical_spring")
    with pytest.raises(ModelError, match="other spring alloy needs 'tensile_strength'"):
        spring.inputs(alloy="other", tensile_strength=None)
    with pytest.raises(ModelError, match="other spring material needs 'shear_modulus'"):
        spring.inputs(material="other", shear_modulus=None)
    by_table = spring.rate(alloy="music_wire", tensile_strength=None, material="monel", shear_modulus=None)
    by_number = spring.rate(alloy="other", tensile_strength="295000 psi", material="other", shear_modulus="9.5e6 psi")
    assert by_table == pytest.approx(by_number, rel=1e-12)


@each_case("material", MATERIAL)
def test_printed_factors_follow_from_the_moduli(material, part):
    """But for those whose printed value is known not to; phosphor bronze and beryllium copper are one material each."""
    rigid = part("helical_spring").factors(material=material, shear_modulus=None)["C_G"]
    elastic = part("beam_spring").factors(material=material, elastic_modulus=None)["C_E"]
    if material != "stainless_302_304_316":
        assert rigid == pytest.approx(MATERIAL.cell(material, "C_G printed"), abs=0.0051)
    if material not in ("stainless_302_304_316", "stainless_17_7_PH", "inconel"):
        assert elastic == pytest.approx(MATERIAL.cell(material, "C_E printed"), abs=0.0061)


@each_case("alloy", STRENGTH)
def test_printed_factors_follow_from_the_strengths(alloy, part):
    found = part("helical_spring").factors(alloy=alloy, tensile_strength=None)["C_Y"]
    assert found == pytest.approx(STRENGTH.cell(alloy, "C_Y printed"), abs=0.0061)
