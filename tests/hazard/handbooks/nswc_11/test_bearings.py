"""NSWC-11 chapter 7 by hand, both ways to the rate."""

import math

import pytest
from tests.cases import each_case

CALM = {
    "kind": "ball", "service": "uniform_steady", "cleanliness": "extreme_clean", "bore": "20 mm",
    "specified_viscosity": "100 cSt", "lubricant_viscosity": "100 cSt", "water": "0 %", "temperature": "40 degC",
    "reliability": "90 %",
}  # fmt: skip
LOADED = {"speed": "1000 rpm", "load": "2 kN", "dynamic_rating": "20 kN"}


def test_by_hand(part):
    """C/P = 10, 1000 rpm: L10h = 10⁶/60000 · 10³ = 16667 h; 60 per 10⁶ h at R = 90 %."""
    assert part("bearing").rate(**CALM, **LOADED) == pytest.approx(1 / 16666.667, rel=1e-3)  # C_R is .9996
    harsh = {
        "service": "moderate_shock", "cleanliness": "normal", "lubricant_viscosity": "50 cSt", "water": "0.5 %",
        "temperature": "200 degC", "reliability": "50 %", "kind": "roller",
    }  # fmt: skip
    base = 60 * 1000 * 0.1**3.3 / 1e6
    c_r = 0.223 / math.log(2) ** (2 / 3)
    expected = base * c_r * 2**0.54 * 9.6875 * (200 / 183) ** 3 * 1.3 * 1.8
    assert part("bearing").rate(**{**CALM, **harsh}, **LOADED) == pytest.approx(expected, rel=1e-12)


def test_the_load_is_counted_once(part):
    """The paper's Eq 1 multiplies C_Y on a life that has the load already: 2⁶ for twice the load."""
    for kind, exponent in (("ball", 3.0), ("roller", 3.3)):
        once, twice = (part("bearing").rate(**{**CALM, **LOADED, "kind": kind, "load": f"{n} kN"}) for n in (2, 4))
        assert twice / once == pytest.approx(2**exponent, rel=1e-12)
    assert "C_Y" not in part("bearing").factors()


@each_case("kind", ["ball", "roller"])
def test_both_ways_are_one(kind, part):
    """A life that is rated at the load of operation, and one at another load."""
    of = {**CALM, "kind": kind}
    exponent = {"ball": 3.0, "roller": 3.3}[kind]
    for at in (2.0, 5.0):
        life = 1e6 / (60 * 1000) * (20 / at) ** exponent
        rated = {"rated_life": f"{life} h", "specified_load": f"{at} kN", "load": "2 kN"}
        assert part("bearing_rated_life").rate(**of, **rated) == pytest.approx(
            part("bearing").rate(**of, **LOADED), rel=1e-12
        )


def test_half_of_them_survive_by_default(part):
    """C_R is .285 by the equation, and the note says so."""
    bearing = part("bearing")
    assert bearing.inputs()["reliability"] == 50
    assert bearing.factors()["C_R"] == pytest.approx(0.285, abs=5e-4)
    assert bearing.factors(reliability="90 %")["C_R"] == pytest.approx(1, abs=5e-4)
    note = next(leaf.note for leaf in bearing.model.explain(bearing.inputs()).leaves() if leaf.symbol == "C_R")
    assert note.startswith("R = 50 %; 90 % counts 3.5 times")


@each_case(("celsius", "factor"), [(-20, 1), (182.9, 1), (183, 1), (366, 8)])
def test_heat(celsius, factor, part):
    assert part("bearing").factors(temperature=float(celsius))["C_t"] == pytest.approx(factor, rel=1e-12)


@each_case(("percent", "factor"), [(0, 1), (0.1, 3.3875), (0.8, 11.0), (0.9, 11.0), (5, 11.0)])
def test_water(percent, factor, part):
    assert part("bearing").factors(water=float(percent))["C_CW"] == pytest.approx(factor, rel=1e-12)


def test_a_bore_of_100_mm_is_a_small_one(part):
    found = [part("bearing").factors(cleanliness="normal", bore=bore)["C_C"] for bore in (20.0, 100.0, 100.1)]
    assert found == [1.8, 1.8, 1.4]
