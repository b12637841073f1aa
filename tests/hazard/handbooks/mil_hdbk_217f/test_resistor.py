"""MIL-HDBK-217F Notice 2 §9.1 against what is printed: Appendix A and the tables of its factors."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.mil_hdbk_217f import ENVIRONMENTS
from robophm.hazard.handbooks.mil_hdbk_217f.resistor import ENVIRONMENT, QUALITY, STYLE

CASES = json.loads((Path(__file__).parents[3] / "data" / "resistor.json").read_text(encoding="utf-8"))["cases"]
WHOLE = [case for case in CASES if "factor" not in case["inputs"]]
SINGLE = [case for case in CASES if "factor" in case["inputs"]]
PLAIN = {"style": "RM", "temperature": "25 degC", "power": "1 W", "rated_power": "2 W", "environment": "GB"}


def written(published):
    """The inputs of a published case as a user writes them; a name that is not known fails."""
    given = {}
    for name, value in published.items():
        match name:
            case "T_C":
                given["temperature"] = f"{value} degC"
            case "P_dissipated_W":
                given["power"] = f"{value} W"
                given["rated_power"] = f"{value / published['S']} W"
            case "piQ":
                given["quality"] = next(word for word, number in QUALITY.items() if number == value)
            case "style" | "environment":
                given[name] = value
            case "S" if "P_dissipated_W" in published:
                pass
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return given


def test_the_cases_are_all_there(carried):
    assert (len(WHOLE), len(SINGLE)) == (45, 41)
    assert carried("resistor", "9.1") == 86


@pytest.mark.parametrize("case", WHOLE, ids=lambda case: case["name"])
def test_published_rates(case, section, agrees):
    agrees(case, section("resistor").rate(written(case["inputs"])))


@pytest.mark.parametrize("case", SINGLE, ids=lambda case: case["name"])
def test_printed_factors(case, section, agrees):
    single_factor(case, section("resistor"), agrees)


def test_the_2020_tool_agrees(original, section, agrees):
    for case in original("9.1"):
        single_factor(case, section("resistor"), agrees)


def single_factor(case, resistor, agrees):
    inputs = dict(case["inputs"])
    factor, column = inputs.pop("factor"), inputs.pop("column", None)
    symbol = {"piT": "πT", "piP": "πP", "piS": "πS"}[factor]
    measured = {"T_C": "temperature", "P_W": "power", "S": "power"}
    ((name, value),) = inputs.items()
    value = value * 2 if name == "S" else value  # of 2 W rated
    styles = [style for style in STYLE if column is None or STYLE.cell(style, f"{symbol} column") == column]
    assert styles
    for style in styles:
        found = resistor.factors({**PLAIN, "style": style}, **{measured[name]: float(value)})
        agrees(case, found[symbol])


def test_worked_by_hand(section):
    """RM, 40 °C, 10 mW of 100 mW, commercial, GM: 0.0037 · πT · 0.01^0.39 · 0.71 exp(0.11) · 10 · 16."""
    inputs = {**PLAIN, "temperature": "40 degC", "power": "10 mW", "rated_power": "100 mW", "environment": "GM"}
    pi_t = math.exp(0.08 / 8.617e-5 * (1 / 298 - 1 / 313))
    expected = 0.0037 * pi_t * 0.01**0.39 * 0.71 * math.exp(0.11) * 10 * 16
    assert section("resistor").rate(inputs) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(("style", "ones"), [("RD", {"πT"}), ("RZ", {"πS"}), ("RTH", {"πT", "πS"})])
def test_factors_that_a_style_has_not(style, ones, section):
    found = section("resistor").factors({**PLAIN, "style": style, "temperature": "100 degC"})
    assert {symbol for symbol in ("πT", "πS", "πP") if found[symbol] == 1} == ones | {"πP"}  # 1 W


def test_overstress_is_refused_in_a_design_and_flagged_live(section):
    resistor = section("resistor").model
    with pytest.raises(ModelError, match=r"πS is outside the handbook's range: column 1, stress S = 1\.5 of at most 1"):
        resistor.settle({**PLAIN, "power": "3 W"})
    value, extrapolated = resistor.evaluate({**resistor.settle(PLAIN), "power": np.array([-1.0, 1.0, 2.0, 2.1, 1e4])})
    assert extrapolated.tolist() == [True, False, False, True, True]
    assert np.all(np.isfinite(value))
    assert np.all(value > 0)


@pytest.mark.parametrize(
    ("said", "style"),
    [("chip resistor", "RM"), ("Chip", "RM"), ("NTC", "RTH"), ("trimpot", "RJ"), ("Metal Film", "RN"), ("RCR", "RCR")],
)
def test_names_that_people_use(said, style, section):
    assert section("resistor").model.settle({**PLAIN, "style": said})["style"] == style


def test_the_tables_agree_row_by_row(second):
    table = second("resistors")
    assert dict(STYLE.rows) == {
        style: (row["lambda_b"], row["piT_col"], row["piS_col"]) for style, row in table["styles"].items()
    }
    for style, row in table["styles"].items():
        assert STYLE.notes[style].split()[0] == row["spec"].split()[0]
    assert dict(QUALITY) == table["piQ"]
    assert dict(ENVIRONMENT) == table["piE"]
    assert list(ENVIRONMENT) == list(ENVIRONMENTS)


def test_printed_tables_agree_to_their_two_digits(second, section):
    printed, checked = second("resistors")["printed"], 0
    for symbol, name, axis in (("πT", "Temperature Factor", "t_"), ("πS", "Power Stress Factor", "s_")):
        for label, row in printed[name].items():
            at = float(label.removeprefix(axis).replace("_", "."))
            for column, value in row.items():
                style = next(s for s in STYLE if STYLE.cell(s, f"{symbol} column") == int(column[-1]))
                measured = {"temperature": at} if symbol == "πT" else {"power": 2 * at}
                found = section("resistor").factors({**PLAIN, "style": style}, **measured)[symbol]
                unit = 10.0 ** (math.floor(math.log10(value)) - 1)
                assert found == pytest.approx(value, abs=0.55 * max(unit, 0.01)), (name, label, column)
                checked += 1
    assert checked == 46
