"""NSWC-11 chapter 8 by hand, and at its reference point."""

import math

import pytest
from tests.cases import each_case

REFERENCE = {
    "speed": "100 rpm", "design_speed": "100 rpm", "misalignment": "0.006 rad", "specified_viscosity": "100 cSt",
    "lubricant_viscosity": "100 cSt", "temperature": "60 degC", "prime_mover": "uniform", "driven_load": "uniform",
}  # fmt: skip


def test_at_design_speed_and_load(part):
    """C_GS = 2 and C_GP = 25.8, as printed; the base is 60 rpm/10⁸ per hour, not a millionth of it."""
    gear = part("gear")
    found = gear.factors(**REFERENCE, load="7 N*m", design_load="7 N*m")
    assert found["C_GS"] == 2
    assert found["C_GP"] == pytest.approx(25.8, abs=0.05)
    assert [found[s] for s in ("C_GA", "C_GL", "C_GT", "C_GV")] == pytest.approx([1, 1, 1, 1], rel=1e-12)
    rate = gear.rate(**REFERENCE, load="7 N*m", design_load="7 N*m")
    assert rate == pytest.approx(60 * 100 / 1e8 * 2 * 2**4.69, rel=1e-12)


def test_at_half_the_load_nothing_is_added(part):
    """The 2020 tool added 0.5 to C_GP and 1 to C_GL."""
    found = part("gear").factors(**REFERENCE, load="5 N*m", design_load="10 N*m")
    assert found["C_GP"] == pytest.approx(1, rel=1e-12)
    thin = part("gear").factors(**{**REFERENCE, "lubricant_viscosity": "25 cSt"})["C_GL"]
    assert thin == pytest.approx(4**0.54, rel=1e-12)


def test_the_base_follows_the_speed_and_the_design_life(part):
    gear = part("gear")
    rates = [gear.rate(**{**REFERENCE, "speed": f"{n} rpm", "design_speed": f"{n} rpm"}) for n in (50, 100)]
    assert rates[1] / rates[0] == pytest.approx(2, rel=1e-12)
    assert gear.rate(**REFERENCE, design_life="1e9 revolution") == pytest.approx(gear.rate(**REFERENCE) / 10, rel=1e-12)


@each_case(("fahrenheit", "factor"), [(-40, 1), (160, 1), (222, 1.1), (470, 1.5)])
def test_heat(fahrenheit, factor, part):
    """The factor is (460 + T)/620 above 160 °F."""
    found = part("gear").factors(temperature=f"{fahrenheit} degF")["C_GT"]
    assert found == pytest.approx(factor, rel=1e-12)


def test_the_misalignment_in_degrees(part):
    """C_GA = 12.44 · degrees^2.36."""
    for degrees in (0.1, 0.34, 1.0):
        assert part("gear").factors(misalignment=degrees)["C_GA"] == pytest.approx(12.44 * degrees**2.36, rel=2e-3)


def test_a_spline_by_hand(part):
    """1 inch wide and long, Brinell 300, 1000 in·lb, 0.006 rad."""
    spline = part("spline")
    geometry = {"hardness": 300, "diameter": "1 inch", "length": "1 inch", "torque": "1000 lbf*inch"}
    phi = 4.85e3 * 300 / 1000
    theta = 7.08e-10 * phi**4.56 * 0.006**-2.36
    assert theta == pytest.approx(math.exp(math.log(7.08e-10) + 4.56 * math.log(1455) - 2.36 * math.log(0.006)))
    assert spline.rate(**REFERENCE, **geometry) == pytest.approx(60 * 100 / theta * 2, rel=1e-9)
    longer = spline.rate(**REFERENCE, **{**geometry, "length": "2 inch"})
    assert longer == pytest.approx(spline.rate(**REFERENCE, **geometry) / 2**4.56, rel=1e-9)
    wider = spline.rate(**REFERENCE, **{**geometry, "diameter": "2 inch"})
    assert wider == pytest.approx(spline.rate(**REFERENCE, **geometry) / 4**4.56, rel=1e-9)  # D³/D
