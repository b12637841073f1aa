"""MIL-HDBK-217F Notice 2 §11 against what is printed: Appendix A, the table of πT, the ways to a hot spot."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.mil_hdbk_217f import coil, transformer
from robophm.hazard.handbooks.mil_hdbk_217f._inductive import CASE, ENVIRONMENT, NEEDS, SLASH_SHEET

DATA = Path(__file__).parents[3] / "data" / "inductive.json"
CASES = json.loads(DATA.read_text(encoding="utf-8"))["cases"]
WHOLE = [case for case in CASES if "factor" not in case["inputs"]]
SINGLE = [case for case in CASES if "factor" in case["inputs"]]
PLAIN = {"kind": "fixed", "temperature": "25 degC", "temperature_rise": "0 K", "environment": "GB"}


def written(published):
    """The inputs of a published case as a user writes them; a name that is not known fails."""
    given = {"kind": "fixed", "temperature_rise": "0 K"}
    for name, value in published.items():
        match name:
            case "THS_C":
                given["temperature"] = f"{value} degC"
            case "type":
                given["kind"] = value
            case "piQ":
                given["quality"] = next(word for word, number in coil.QUALITY.items() if number == value)
            case "quality" | "environment":
                given[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return given


def test_the_cases_are_all_there(carried):
    assert (len(WHOLE), len(SINGLE)) == (20, 12)
    assert carried("inductive", "11.1", "11.2") == 32


@pytest.mark.parametrize("case", WHOLE, ids=lambda case: case["name"])
def test_published_rates(case, section, agrees):
    name = {"11.1": "transformer", "11.2": "coil"}[case["section"]]
    agrees(case, section(name).rate(written(case["inputs"])))


@pytest.mark.parametrize("case", SINGLE, ids=lambda case: case["name"])
def test_printed_factors(case, section, agrees):
    assert case["inputs"].keys() == {"factor", "THS_C"}
    assert case["inputs"]["factor"] == "piT"
    agrees(case, section("coil").factors(PLAIN, temperature=float(case["inputs"]["THS_C"]))["πT"])


def test_the_2020_tool_agrees(original, section, agrees):
    for case in original("11.2"):
        agrees(case, section("coil").factors(PLAIN, temperature=float(case["inputs"]["THS_C"]))["πT"])


def test_worked_by_hand(section):
    """A fixed coil at 40 °C, 20 K above it on average, lower quality, GM: hot spot at 40 + 1.1 · 20 = 62 °C."""
    inputs = {**PLAIN, "temperature": "40 degC", "temperature_rise": "20 K", "environment": "GM"}
    expected = 0.000030 * math.exp(0.11 / 8.617e-5 * (1 / 298 - 1 / 335)) * 3 * 12
    assert section("coil").rate(inputs) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("given", "rise"),
    [
        ({"temperature_rise": "10 K"}, 10),
        ({"rise_from": "39010/5C"}, 15),
        ({"rise_from": "39010/11"}, 35),
        ({"rise_from": "case_area", "power_loss": "2 W", "case_area": f"{25 * 2.54**2} cm^2"}, 125 * 2 / 25),
        ({"rise_from": "case_area", "power_loss": "2 W", "case_area": "25 in^2"}, 125 * 2 / 25),
        ({"rise_from": "T27/FB", "power_loss": "2 W"}, 125 * 2 / 25),
        ({"rise_from": "weight", "power_loss": "2 W", "weight": "3 lb"}, 11.5 * 2 / 3**0.6766),
        ({"rise_from": "weight", "power_loss": "2 W", "weight": f"{3 * 0.45359237} kg"}, 11.5 * 2 / 3**0.6766),
        ({"rise_from": "input_power", "input_power": "30 W", "weight": "3 lb"}, 2.1 * 30 / 3**0.6766),
    ],
)
@pytest.mark.parametrize("name", ["coil", "transformer"])
def test_the_ways_to_a_hot_spot(name, given, rise, section):
    plain = {"kind": {"coil": "fixed", "transformer": "audio"}[name], "temperature": "30 degC", "environment": "GB"}
    expected = math.exp(0.11 / 8.617e-5 * (1 / 298 - 1 / (30 + 1.1 * rise + 273)))
    assert section(name).factors({**plain, **given})["πT"] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("way", NEEDS)
@pytest.mark.parametrize("name", ["coil", "transformer"])
def test_one_way_to_the_hot_spot_is_required(way, name, section):
    plain = {"kind": {"coil": "fixed", "transformer": "audio"}[name], "temperature": "30 degC", "environment": "GB"}
    if NEEDS[way]:
        with pytest.raises(ModelError, match=f"rise_from {way} needs '{NEEDS[way][0]}'.*; other ways: case_area, "):
            section(name).rate({**plain, "rise_from": way})
    else:
        assert section(name).rate({**plain, "rise_from": way}) > 0


def test_a_hot_spot_beyond_the_table_is_refused_in_a_design_and_flagged_live(section):
    part = section("coil")
    with pytest.raises(ModelError, match=r"πT is outside the handbook's range: .* hot spot at 210 °C"):
        part.rate({**PLAIN, "temperature": "100 degC", "temperature_rise": "100 K"})
    design = part.model.settle({**PLAIN, "temperature_rise": "10 K"})
    value, extrapolated = part.model.evaluate({**design, "temperature": np.array([-300.0, 20.0, 179.0, 180.0, 191.0])})
    assert extrapolated.tolist() == [True, False, False, True, True]
    assert np.all(value >= 0)


def test_the_tables_agree_row_by_row(second):
    table = second("inductive")
    assert dict(transformer.KIND) == table["transformer_lambda_b"]
    assert dict(transformer.QUALITY) == table["piQ_transformer"]
    assert dict(coil.KIND) == table["coil_lambda_b"]
    assert dict(coil.QUALITY) == table["piQ_coil"]
    assert dict(ENVIRONMENT) == table["piE"]
    hot_spot = table["hot_spot"]
    assert {key.removeprefix("T27/"): area for key, area in CASE.items()} == hot_spot["case_areas_in2_MIL-T-27"]
    for rise in (15, 35):
        (label,) = (key for key, value in hot_spot.items() if value == rise)
        sheets = "_".join(key.removeprefix("39010/") for key, value in SLASH_SHEET.items() if value == rise)
        assert label.removeprefix("dT_MIL-C-39010_").replace("1C-3C", "1C_2C_3C") == sheets


def test_the_printed_table_agrees_to_its_two_digits(second, section):
    rows = second("inductive")["printed_piT"]
    assert len(rows) == 18
    for label, value in rows.items():
        found = section("coil").factors(PLAIN, temperature=float(label[2:]))["πT"]
        assert found == pytest.approx(value, abs=0.055), label
