"""MIL-HDBK-217F Notice 2 §6.5 and §6.10, unijunction transistors and thyristors: printed formulas and factors."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import ENVIRONMENT, QUALITY

DATA = Path(__file__).parents[3] / "data" / "thyristor.json"
CASES = json.loads(DATA.read_text(encoding="utf-8"))["cases"]
HEAT = {"temperature": "45 degC", "power": "1 W", "package": "TO-220", "environment": "GM"}
PLAIN = {**HEAT, "rated_current": "4 A", "voltage": "24 V", "rated_voltage": "40 V"}


def test_the_cases_are_all_there(carried):
    assert carried("thyristor", "6.5", "6.10") == len(CASES) == 2


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_printed_factors(case, section, agrees):
    inputs = dict(case["inputs"])
    match inputs.pop("factor"), list(inputs):
        case "piR", ["I_A"]:
            found = section("thyristor").factors(PLAIN, rated_current=inputs["I_A"])["πR"]
        case "piS", ["S"]:
            found = section("thyristor").factors(PLAIN, voltage=40 * inputs["S"])["πS"]
        case unknown:
            pytest.fail(f"the published factor {unknown} is not known here")
    agrees(case, found)


def test_worked_by_hand(section):
    """TJ = 45 + 5 · 1 = 50 °C; 4 A, 24 of 40 V, plastic, GM."""
    thyristor = 0.0022 * math.exp(3082 * (1 / 298 - 1 / 323)) * 4**0.4 * 0.6**1.9 * 8 * 9
    assert section("thyristor").rate(PLAIN) == pytest.approx(thyristor, rel=1e-13)
    unijunction = 0.0083 * math.exp(2483 * (1 / 298 - 1 / 323)) * 8 * 9
    assert section("transistor_unijunction").rate(HEAT) == pytest.approx(unijunction, rel=1e-13)


@pytest.mark.parametrize(("stress", "expected"), [(0.0, 0.1), (0.3, 0.1), (0.31, 0.31**1.9), (1.0, 1.0)])
def test_voltage_stress(stress, expected, section):
    assert section("thyristor").factors(PLAIN, voltage=40 * stress)["πS"] == pytest.approx(expected, rel=1e-14)


def test_overstress_is_refused_in_a_design_and_flagged_live(section):
    part = section("thyristor")
    with pytest.raises(ModelError, match=r"πS is outside the handbook's range: .* = 1\.5 of at most 1"):
        part.rate({**PLAIN, "voltage": "60 V"})
    value, extrapolated = part.model.evaluate({**part.model.settle(PLAIN), "voltage": np.array([-1.0, 40.0, 41.0])})
    assert extrapolated.tolist() == [True, False, True]
    assert np.all(value > 0)


def test_the_tables_agree(second, section):
    table = second("transistors")
    for name, inputs, key in (
        ("thyristor", PLAIN, "6.10_thyristor"),
        ("transistor_unijunction", HEAT, "6.5_unijunction"),
    ):
        row, cold = table[key], section(name).factors({**inputs, "power": "0 W"}, temperature=25.0)
        assert cold["λb"] == row["lambda_b"]
        assert cold["πT"] == 1
        hot = section(name).factors({**inputs, "power": "0 W"}, temperature=100.0)["πT"]
        assert hot == pytest.approx(math.exp(-row["B"] * (1 / 373 - 1 / 298)), rel=1e-14)
        assert dict(QUALITY) == row["piQ"]
        assert dict(ENVIRONMENT) == row["piE"]
