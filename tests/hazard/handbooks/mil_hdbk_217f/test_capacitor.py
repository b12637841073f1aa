"""MIL-HDBK-217F Notice 2 §10.1 against what is printed: worked example, Appendix A, and the tables of its factors."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f import ENVIRONMENTS, handbook_arrhenius
from robophm.hazard.handbooks.mil_hdbk_217f.capacitor import ENVIRONMENT, QUALITY, STYLE

CASES = json.loads((Path(__file__).parents[3] / "data" / "capacitor.json").read_text())["cases"]
WHOLE = [case for case in CASES if "factor" not in case["inputs"]]
SINGLE = [case for case in CASES if "factor" in case["inputs"]]
CAPACITOR = handbook_model("mil_hdbk_217f.capacitor")
OURS = {"piT": "πT", "piC": "πC", "piV": "πV", "piSR": "πSR"}
PLAIN = {
    "capacitance": "1 uF",
    "temperature": "25 degC",
    "dc_voltage": "0.5 V",
    "rated_voltage": "1 V",
    "series_resistance": "1 ohm/V",
    "environment": "GB",
}


def settled(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    given = {}
    for name, value in published.items():
        match name:
            case "S":
                given |= {"dc_voltage": f"{value} V", "rated_voltage": "1 V"}
            case "piQ":
                given["quality"] = next(word for word, number in QUALITY.items() if number == value)
            case "C_uF" | "TA_C" | "Vdc" | "Vac_rms" | "V_rated" | "CR_ohm_per_V":
                ours, unit = {
                    "C_uF": ("capacitance", "uF"),
                    "TA_C": ("temperature", "degC"),
                    "Vdc": ("dc_voltage", "V"),
                    "Vac_rms": ("ac_voltage", "V"),
                    "V_rated": ("rated_voltage", "V"),
                    "CR_ohm_per_V": ("series_resistance", "ohm/V"),
                }[name]
                given[ours] = f"{value} {unit}"
            case "style" | "quality" | "environment":
                given[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return CAPACITOR.settle(given)


def factors(inputs):
    return {factor.symbol: float(np.asarray(factor.value)) for factor in CAPACITOR.explain(inputs).leaves()}


def within(tolerance, expected):
    return pytest.approx(expected, rel=tolerance.get("rel", 0), abs=tolerance.get("abs", 0))


def test_the_cases_are_all_there():
    assert (len(WHOLE), len(SINGLE)) == (67, 75)
    assert all(case["source"] for case in CASES)
    published = {case["name"].split("_")[2] for case in WHOLE if case["name"].startswith("appA")}
    assert published == {"cdr", "ch", "ck", "clr", "cm", "csr", "cu"}


@pytest.mark.parametrize("case", WHOLE, ids=lambda case: case["name"])
def test_published_rates(case):
    inputs = settled(case["inputs"])
    assert case["expected"]["unit"] == "f/1e6h"
    rate = CAPACITOR.evaluate(inputs).value * 1e6
    assert rate == within(case["tolerance"], case["expected"]["value"])
    for name, printed in case.get("intermediate", {}).items():  # two printed digits
        assert factors(inputs)[OURS[name]] == pytest.approx(printed, rel=0.05)


@pytest.mark.parametrize("case", SINGLE, ids=lambda case: case["name"])
def test_printed_factors(case):
    inputs = dict(case["inputs"])
    symbol, column = OURS[inputs.pop("factor")], inputs.pop("column")
    styles = [style for style in STYLE if STYLE.cell(style, f"{symbol} column") == column]
    assert styles
    for style in styles:
        found = factors({**CAPACITOR.settle({"style": style, **PLAIN}), **numbers(inputs)})
        assert found[symbol] == within(case["tolerance"], case["expected"]["value"]), style


def numbers(inputs):
    """The inputs of a single-factor case; its S is of a rated voltage of 1 V."""
    ours = {"S": "dc_voltage", "C_uF": "capacitance", "TA_C": "temperature"}
    return {ours[name]: value for name, value in inputs.items()}


def test_worked_by_hand():
    """CDR, 0.1 µF, 60 °C, S = 0.5, commercial, GM: 0.0020 · 4.1895 · 0.1^0.09 · (1 + (5/6)³) · 10 · 20."""
    inputs = CAPACITOR.settle({
        "style": "CDR", "capacitance": "100 nF", "temperature": "60 degC", "dc_voltage": "8 V",
        "rated_voltage": "16 V", "environment": "GM",
    })  # fmt: skip
    pi_t = math.exp(0.35 / 8.617e-5 * (1 / 298 - 1 / 333))
    expected = 0.0020 * pi_t * 0.1**0.09 * (1 + (5 / 6) ** 3) * 10 * 20 * 1e-6
    assert CAPACITOR.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("resistance", "printed"),
    [(0.81, 0.66), (0.8, 1.0), (0.61, 1.0), (0.6, 1.3), (0.4, 2.0), (0.2, 2.7), (0.1, 3.3), (0.05, 3.3), (5, 0.66)],
)
def test_series_resistance_bands_are_printed_as_greater_than(resistance, printed):
    inputs = {"style": "CSR", **PLAIN, "series_resistance": f"{resistance} ohm/V"}
    assert factors(CAPACITOR.settle(inputs))["πSR"] == printed


@pytest.mark.parametrize("style", STYLE)
def test_only_solid_tantalum_asks_for_the_series_resistance(style):
    inputs = {key: value for key, value in PLAIN.items() if key != "series_resistance"}
    if style in ("CSR", "CWR"):
        with pytest.raises(ModelError, match=f"style {style} needs 'series_resistance'"):
            CAPACITOR.settle({"style": style, **inputs})
    else:
        assert factors(CAPACITOR.settle({"style": style, **inputs}))["πSR"] == 1


def test_ac_counts_by_its_peak():
    inputs = {"style": "CDR", **PLAIN, "rated_voltage": "10 V"}
    together = CAPACITOR.settle({**inputs, "dc_voltage": "5 V", "ac_voltage": "2 V"})
    peak = CAPACITOR.settle({**inputs, "dc_voltage": f"{5 + 2 * 2**0.5} V"})
    assert CAPACITOR.evaluate(together).value == pytest.approx(CAPACITOR.evaluate(peak).value, rel=1e-14)


def test_overstress_is_refused_in_a_design_and_flagged_live():
    inputs = {"style": "CDR", **PLAIN, "rated_voltage": "10 V"}
    with pytest.raises(ModelError, match=r"πV is outside the handbook's range: column 3, stress S = 1\.2 of at most 1"):
        CAPACITOR.settle({**inputs, "dc_voltage": "12 V"})
    with pytest.raises(ModelError, match="outside"):
        CAPACITOR.settle({**inputs, "dc_voltage": "8 V", "ac_voltage": "2 V"})
    design = CAPACITOR.settle({**inputs, "dc_voltage": "10 V"})
    value, extrapolated = CAPACITOR.evaluate({**design, "dc_voltage": np.array([5.0, 10.0, 10.01, 30.0])})
    assert extrapolated.tolist() == [False, False, True, True]
    assert np.all(np.diff(value) > 0)


def test_reversed_polarity_and_broken_sensors_give_no_negative_rate():
    design = CAPACITOR.settle({"style": "CDR", **PLAIN, "rated_voltage": "10 V"})
    for name, values in (("dc_voltage", [-30.0, -10.0, -0.01]), ("temperature", [-1000.0, -273.0, -60.0])):
        value, extrapolated = CAPACITOR.evaluate({**design, name: np.array(values)})
        assert np.all(value >= 0), name
        assert np.all(value < 1e-3), name
        assert np.all(extrapolated)


def test_a_measured_input_that_the_style_does_not_use_changes_nothing():
    design = CAPACITOR.settle({"style": "CDR", **PLAIN})
    value, extrapolated = CAPACITOR.evaluate({**design, "series_resistance": np.array([0.1, 1.0, -1.0])})
    assert value.tolist() == [float(CAPACITOR.evaluate(design).value)] * 3
    assert extrapolated.tolist() == [False, False, True]


def test_the_handbook_rounds_its_physics():
    assert handbook_arrhenius(25.0, 0.35) == 1
    assert handbook_arrhenius(75.0, 0.35) == pytest.approx(math.exp(0.35 / 8.617e-5 * (1 / 298 - 1 / 348)), rel=1e-15)


@pytest.fixture(scope="module")
def second(shared):
    """A second transcription of the section's tables."""
    return YAML(typ="safe").load(shared / "handbook" / "tables" / "mil217_capacitors.yaml")


def test_styles_agree_row_by_row(second):
    theirs = {
        style: (row["lambda_b"], row["piT_col"], row["piC_col"], row["piV_col"], float(row["piSR"]))
        for style, row in second["styles"].items()
    }
    assert dict(STYLE.rows) == theirs
    for style, row in second["styles"].items():
        assert re.match(rf"{row['spec'].split()[0]}\b", STYLE.notes[style])


def test_quality_and_environment_agree_row_by_row(second):
    assert dict(QUALITY) == second["piQ"]
    assert dict(ENVIRONMENT) == second["piE"]
    assert list(ENVIRONMENT) == list(ENVIRONMENTS)


@pytest.mark.parametrize("printed", ["piT", "piC", "piV"])
def test_printed_tables_agree_to_their_two_digits(second, printed):
    """The printed tables are the equations, rounded to two digits (0.01 below 1): half a unit of the last, and a hair.

    166 and the integers above 100 are printed to two or three digits; 5 % covers a unit of the second.
    """
    symbol = OURS[printed]
    axis = {"piT": ("c_", "temperature"), "piC": ("cf_", "capacitance"), "piV": ("vs_", "dc_voltage")}[printed]
    for column, rows in second["printed"][printed].items():
        style = next(s for s in STYLE if STYLE.cell(s, f"{symbol} column") == int(column.removeprefix("column_")))
        design = CAPACITOR.settle({"style": style, **PLAIN})
        for label, value in rows.items():
            at = float(label.removeprefix(axis[0]).replace("_", "."))
            unit = 10.0 ** (math.floor(math.log10(value)) - 1)  # of the second digit
            found = factors({**design, axis[1]: at})[symbol]
            assert found == pytest.approx(value, abs=0.55 * max(unit, 0.01)), (column, label)


def test_the_carried_cases_are_the_published_ones(shared):
    published = json.loads((shared / "cases" / "handbook.json").read_text())["cases"]
    here = {case["name"]: case for case in CASES}
    there = {c["name"]: c for c in published if c["section"] in ("10.1", "10.2") and not c.get("disputed")}
    there = {name: c for name, c in there.items() if c["handbook"].startswith("MIL")}
    assert here.keys() == there.keys()
    for name, case in here.items():
        assert all(there[name][key] == value for key, value in case.items()), name
