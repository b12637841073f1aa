"""Rates that somebody states, against the paper's Table 4 and the closed forms of a maker's figures."""

import math

import numpy as np
import pytest
from scipy.stats import weibull_min
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model


def rate(name, **given):
    model = handbook_model(name)
    return float(model.evaluate(model.settle(given)).value)


@each_case(("chemistry", "printed"), [("primary", 20e-9), ("nickel_cadmium", 100e-9), ("lithium_ion", 150e-9)])
def test_batteries_of_the_papers_table_4(chemistry, printed):
    assert rate("general.battery", chemistry=chemistry) == pytest.approx(printed, rel=1e-15)


@each_case(
    ("word", "chemistry"),
    [("Li-Ion", "lithium_ion"), ("LiPo", "lithium_ion"), ("NiCd", "nickel_cadmium"), ("alkaline", "primary")],
)
def test_what_people_call_a_battery(word, chemistry):
    assert handbook_model("general.battery").settle({"chemistry": word}) == {"chemistry": chemistry}


def test_a_rate_by_a_standard_says_where_it_is_from():
    given = {"rate": "12 FIT", "standard": "telcordia", "source": "issue 4,  method I, 40 degC"}
    model = handbook_model("general.external")
    assert rate("general.external", **given) == 12e-9
    (leaf,) = model.explain(model.settle(given)).leaves()
    assert leaf.note == "Telcordia SR-332: issue 4, method I, 40 degC"
    with pytest.raises(ModelError, match=r"^general\.external needs the input 'source' \(words"):
        model.settle({"rate": "12 FIT", "standard": "FIDES"})
    with pytest.raises(ModelError, match="standard 'FIDS' is not one of its choices; did you mean 'FIDES'"):
        model.settle({**given, "standard": "FIDS"})


def test_a_makers_mtbf():
    assert rate("general.mtbf", mtbf="170000 h", source="data sheet") == pytest.approx(5.882e-6, rel=1e-4)
    assert rate("general.mtbf", mtbf="20 year", source="x") == pytest.approx(1 / (20 * 365.25 * 24), rel=1e-12)


@each_case("shape", [0.7, 1.0, 1.5, 3.0, 10.0])
@each_case(("name", "unit"), [("b10", "h"), ("b10_cycles", "cycle")])
def test_a_tenth_fails_by_b10(name, unit, shape):
    """1/λ is the mean of the Weibull distribution whose 10 % quantile is B10, by another program."""
    scale = 5e4 / weibull_min.ppf(0.1, shape)
    found = rate(f"general.{name}", b10=f"50000 {unit}", shape=shape, source="x")
    assert 1 / found == pytest.approx(weibull_min.mean(shape, scale=scale), rel=1e-12)


def test_b10_with_a_constant_rate():
    """ISO 13849-1 rounds −ln 0.9 = 0.10536 to 0.1: MTTF = B10/(0.1 n)."""
    found = rate("general.b10_cycles", b10="2e7 cycle", source="x")
    assert found == pytest.approx(-math.log(0.9) / 2e7, rel=1e-15)
    assert found == pytest.approx(0.1 / 2e7, rel=0.06)
    assert handbook_model("general.b10_cycles").unit == "1/cycle"


def test_broken_values_give_no_negative_rate():
    for name in ("general.mtbf", "general.b10"):
        model = handbook_model(name)
        key = next(iter(model.inputs))
        value, extrapolated = model.evaluate({**model.settle({key: "10 h", "source": "x"}), key: np.array([-5.0])})
        assert value > 0
        assert extrapolated
