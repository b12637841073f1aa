"""MIL-HDBK-217F Notice 2 §6.1 against what is printed: Appendix A and the tables of its factors."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import ENVIRONMENT, QUALITY
from robophm.hazard.handbooks.mil_hdbk_217f.diode_low_frequency import CONTACT, KIND

DATA = Path(__file__).parents[3] / "data" / "diode_low_frequency.json"
CASES = json.loads(DATA.read_text(encoding="utf-8"))["cases"]
WHOLE = [case for case in CASES if "factor" not in case["inputs"]]
SINGLE = [case for case in CASES if "factor" in case["inputs"]]
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


def written(published):
    """The inputs of a published case as a user writes them; a name that is not known fails."""
    given = {}
    for name, value in published.items():
        match name:
            case "diode_type":
                given["kind"] = value
            case "TJ_C":
                given |= {"temperature": f"{value} degC", "power": "0 W"}
            case "S":
                given |= {"voltage": f"{value} V", "rated_voltage": "1 V"}
            case "piC":
                given["contact"] = next(word for word, number in CONTACT.items() if number == value)
            case "piQ":
                given["quality"] = next(word for word, number in QUALITY.items() if number == value)
            case "environment":
                given[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return given


def single_factor(case, diode, agrees):
    inputs = dict(case["inputs"])
    match inputs.pop("factor"):
        case "piT":
            kinds = [kind for kind in KIND if KIND.cell(kind, "B") == inputs["B"]]
            assert len(kinds) in (3, 6)
            assert inputs.keys() == {"B", "TJ_C"}
            for kind in kinds:
                agrees(case, diode.factors({**PLAIN, "kind": kind}, temperature=float(inputs["TJ_C"]))["πT"])
        case "piS":
            assert inputs.keys() == {"S"}
            agrees(case, diode.factors(PLAIN, voltage=10 * inputs["S"])["πS"])
        case factor:
            pytest.fail(f"the published factor '{factor}' is not known here")


def test_the_cases_are_all_there(carried):
    assert (len(WHOLE), len(SINGLE)) == (51, 38)
    assert carried("diode_low_frequency", "6.1") == 89


@pytest.mark.parametrize("case", WHOLE, ids=lambda case: case["name"])
def test_published_rates(case, diode, agrees):
    agrees(case, diode.rate(written(case["inputs"])))


@pytest.mark.parametrize("case", SINGLE, ids=lambda case: case["name"])
def test_printed_factors(case, diode, agrees):
    single_factor(case, diode, agrees)


def test_the_2020_tool_agrees_on_single_factors(original, diode, agrees):
    for case in original("6.1"):
        single_factor(case, diode, agrees)


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


@pytest.mark.parametrize(
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


@pytest.mark.parametrize("kind", KIND)
def test_voltage_counts_where_the_handbook_says_so(kind, diode):
    rest = {key: value for key, value in PLAIN.items() if "voltage" not in key}
    if kind.startswith(("transient", "current_reg", "voltage")):
        assert diode.factors({**rest, "kind": kind})["πS"] == 1
    else:
        with pytest.raises(ModelError, match=f"kind {kind} needs 'voltage' and 'rated_voltage'"):
            diode.rate({**rest, "kind": kind})


@pytest.mark.parametrize(("volts", "expected"), [(0.0, 0.054), (3.0, 0.054), (3.1, 0.31**2.43), (10.0, 1.0)])
def test_voltage_stress(volts, expected, diode):
    assert diode.factors(PLAIN, voltage=volts)["πS"] == pytest.approx(expected, rel=1e-14)


def test_overstress_and_a_hot_junction_are_refused_in_a_design_and_flagged_live(diode):
    with pytest.raises(ModelError, match=r"πS is outside the handbook's range: .* S = 1\.2 of at most 1"):
        diode.rate({**PLAIN, "voltage": "12 V"})
    with pytest.raises(ModelError, match=r"πT is outside the handbook's range: .* TJ = 195 °C"):
        diode.rate({**PLAIN, "temperature": "125 degC", "power": "1 W"})
    assert diode.rate({**PLAIN, "temperature": "125 degC", "power": "0.5 W", "thermal_resistance": "100 K/W"}) > 0
    design = diode.model.settle(PLAIN)
    value, extrapolated = diode.model.evaluate({**design, "voltage": np.array([-5.0, 0.0, 3.0, 10.0, 11.0])})
    assert extrapolated.tolist() == [True, False, False, False, True]
    assert np.all(value > 0)
    value, extrapolated = diode.model.evaluate({**design, "temperature": np.array([-300.0, 25.0, 180.0])})
    assert extrapolated.tolist() == [True, False, True]
    assert np.all(value >= 0)


def test_the_tables_agree_row_by_row(second):
    table = second("diodes")["low_frequency_6_1"]
    theirs = {kind: (row["lambda_b"], row["B"], float(row["stress"])) for kind, row in table["types"].items()}
    theirs["high_voltage_stack"] = theirs.pop("high_voltage_stack_per_junction")
    assert dict(KIND.rows) == theirs
    assert list(CONTACT.values()) == list(table["piC"].values())
    assert dict(QUALITY) == table["piQ"]
    assert dict(ENVIRONMENT) == table["piE"]


def test_printed_tables_agree_to_their_two_digits(second, diode):
    for kind, name in (("switching", "B3091"), ("voltage_reference", "B1925")):
        rows = second("diodes")["printed_piT"][name]
        assert len(rows) == 31
        for label, value in rows.items():
            found = diode.factors({**PLAIN, "kind": kind}, temperature=float(label[2:]))["πT"]
            assert found == pytest.approx(value, abs=0.55 * 10.0 ** (math.floor(math.log10(value)) - 1)), label
