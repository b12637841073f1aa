"""MIL-HDBK-217F Notice 2 §15.1 against Appendix A and the printed table of πT."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.connector import ENVIRONMENT, MATING, QUALITY, STYLE, WIRE

CASES = json.loads((Path(__file__).parents[3] / "data" / "connector.json").read_text())["cases"]
CONNECTOR = handbook_model("mil_hdbk_217f.connector")
PLAIN = {
    "style": "circular", "temperature": "25 degC", "current": "0 A", "wire_gauge": "22", "matings": "0 /10^3 h",
    "quality": "MIL-SPEC", "environment": "GB",
}  # fmt: skip


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "TA_C" | "T0_C":
                ours["temperature"] = f"{value} degC"
            case "dT_C":
                assert value == 0
                ours["current"] = "0 A"
            case "matings_per_1000h":
                ours["matings"] = f"{value} /10^3 h"
            case "type":
                ours["style"] = value.replace("_", "-")
            case "quality" | "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    inputs = dict(case["inputs"])
    symbol = {None: None, "piT": "πT"}[inputs.pop("factor", None)]
    answers(CONNECTOR, case, {**PLAIN, **given(inputs)}, symbol)


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 34
    as_published(CASES, "15.1")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("connectors")
    assert {k: v for k, v in STYLE.items() if k != "rf-coaxial-power"} == {
        key.replace("_", "-"): value for key, value in theirs["lambda_b_mated_pair"].items()
    }
    assert {int(gauge): value for gauge, value in WIRE.items()} == theirs["insert_dT"]["coef"]
    assert list(MATING.values()) == [row[1] for row in theirs["piK_per_1000h"]]
    assert [float(limit) for limit in MATING][:-1] == [row[0] for row in theirs["piK_per_1000h"]][:-1]
    assert dict(QUALITY) == theirs["piQ"]
    assert dict(ENVIRONMENT) == theirs["piE"]
    for label, value in theirs["printed_piT"].items():
        design = CONNECTOR.settle({**PLAIN, "temperature": f"{label[2:]} degC"})
        assert factors(CONNECTOR, design)["πT"] == pytest.approx(value, abs=0.55 if value == 10 else 0.055)


def test_worked_by_hand():
    """Rectangular, 40 °C, 2 A through AWG 22: 0.989 · 2^1.85 °C warmer; 100 matings in 1000 h, lower quality, GM."""
    inputs = CONNECTOR.settle({
        "style": "rectangular", "temperature": "40 degC", "current": "2 A", "wire_gauge": "22",
        "matings": "100 /10^3 h", "environment": "GM",
    })  # fmt: skip
    insert = 40 + 0.989 * 2**1.85
    expected = 0.046 * math.exp(-0.14 / 8.617e-5 * (1 / (insert + 273) - 1 / 298)) * 4 * 2 * 8 * 1e-6
    assert CONNECTOR.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)
    half = CONNECTOR.settle({**inputs, "half": "one half"} | {
        "temperature": "40 degC", "current": "2 A", "matings": "100 /10^3 h"
    })  # fmt: skip
    assert CONNECTOR.evaluate(half).value == pytest.approx(expected / 2, rel=1e-14)


@pytest.mark.parametrize(("style", "rise"), [("rf-coaxial", 5), ("rf-coaxial-power", 50)])
def test_radio_frequency_inserts_do_not_ask_for_the_current(style, rise, factors):
    inputs = {key: value for key, value in PLAIN.items() if key not in ("current", "wire_gauge")}
    found = factors(CONNECTOR, CONNECTOR.settle({**inputs, "style": style}))
    with_current = factors(CONNECTOR, CONNECTOR.settle({**PLAIN, "style": style, "current": "20 A"}))
    warmer = factors(CONNECTOR, CONNECTOR.settle({**PLAIN, "temperature": f"{25 + rise} degC"}))
    assert found["πT"] == with_current["πT"] == warmer["πT"]


@pytest.mark.parametrize("missing", ["current", "wire_gauge"])
def test_the_current_counts_or_there_is_no_answer(missing):
    """The 2020 tool left the temperature rise of the insert out."""
    with pytest.raises(ModelError, match="style circular needs 'current'"):
        CONNECTOR.settle({key: value for key, value in PLAIN.items() if key != missing})
    with pytest.raises(ModelError, match="wire_gauge '26' is not one of its choices"):
        CONNECTOR.settle({**PLAIN, "wire_gauge": "26"})


@pytest.mark.parametrize(
    ("matings", "printed"), [(0, 1), (0.05, 1), (0.051, 1.5), (0.5, 1.5), (5, 2), (50, 3), (50.1, 4), (1e4, 4)]
)
def test_matings(matings, printed, factors):
    assert factors(CONNECTOR, CONNECTOR.settle({**PLAIN, "matings": f"{matings} /10^3 h"}))["πK"] == printed


def test_an_insert_beyond_the_printed_temperatures():
    with pytest.raises(ModelError, match=r"πT is outside the handbook's range: insert at .* °C of at most 250"):
        CONNECTOR.settle({**PLAIN, "temperature": "100 degC", "current": "20 A"})
    design = CONNECTOR.settle(PLAIN)
    value, extrapolated = CONNECTOR.evaluate({**design, "current": np.array([-20.0, 0.0, 5.0, 20.0])})
    assert extrapolated.tolist() == [True, False, False, True]
    assert value[0] == value[3]
