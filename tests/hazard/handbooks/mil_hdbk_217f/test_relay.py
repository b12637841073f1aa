"""MIL-HDBK-217F Notice 2 §13.1 against Appendix A and the printed tables of λb and πL."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.relay import CONSTRUCTION, CONTACT_FORM, ENVIRONMENT, QUALITY

CASES = json.loads((Path(__file__).parents[3] / "data" / "relay.json").read_text())["cases"]
RELAY = handbook_model("mil_hdbk_217f.relay")
PLAIN = {
    "construction": "general-balanced-armature", "rated_temperature": "125 degC", "temperature": "25 degC",
    "load": "resistive", "load_current": "0 A", "rated_current": "1 A", "contact_form": "SPST",
    "cycling": "10 cycle/h", "quality": "M", "environment": "GB",
}  # fmt: skip


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "rated_temp_C" | "rated_C":
                ours["rated_temperature"] = f"{value} degC"
            case "TA_C":
                ours["temperature"] = f"{value} degC"
            case "load":
                ours["load"] = value.lower()
            case "S":
                ours |= {"load_current": f"{value} A", "rated_current": "1 A"}
            case "cycles_per_h":
                ours["cycling"] = f"{value} cycle/h"
            case "construction":
                known = {"0-5 A general purpose balanced armature (piF 5)": "general-balanced-armature"}
                ours["construction"] = known[value]
            case "piQ":
                ours["quality"] = next(word for word, number in QUALITY.items() if number == value)
            case "contact_form" | "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    inputs = dict(case["inputs"])
    symbol = {None: None, "lambda_b": "λb", "piL": "πL"}[inputs.pop("factor", None)]
    answers(RELAY, case, {**PLAIN, **given(inputs)}, symbol)


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 46
    as_published(CASES, "13.1")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("relays")
    assert dict(CONTACT_FORM) == theirs["piC"]
    assert dict(CONSTRUCTION) == {key.replace("_", "-"): value for key, value in theirs["piF"].items()}
    assert dict(QUALITY) == theirs["piQ"]
    assert dict(ENVIRONMENT) == {key: value for key, value in theirs["piE"].items() if value is not None}
    for label, ratings in theirs["printed_lambda_b"].items():
        for rating, value in ratings.items():
            design = RELAY.settle({
                **PLAIN, "temperature": f"{label[2:]} degC", "rated_temperature": f"{rating[2:]} degC"
            })  # fmt: skip
            digit = 0.001 if value >= 0.01 else 0.0001
            assert factors(RELAY, design)["λb"] == pytest.approx(value, abs=0.62 * digit), (label, rating)
    for label, loads in theirs["printed_piL"].items():
        stress = float(label[2:].replace("_", "."))
        for load, value in loads.items():
            design = RELAY.settle({**PLAIN, "load": load.lower(), "load_current": f"{stress} A"})
            assert factors(RELAY, design)["πL"] == pytest.approx(value, rel=0.006), (label, load)


def test_worked_by_hand():
    """Inductive 2 A of 5 A, SPDT, 30 an hour, 60 °C of 125, general armature (long), commercial, GM."""
    inputs = RELAY.settle({
        "construction": "general-armature-long", "rated_temperature": "125", "temperature": "60 degC",
        "load": "inductive", "load_current": "2 A", "rated_current": "5 A", "contact_form": "SPDT",
        "cycling": "30 cycle/h", "environment": "GM",
    })  # fmt: skip
    base = 0.0059 * math.exp(-0.17 / 8.617e-5 * (1 / 333 - 1 / 298))
    expected = base * math.e * 1.75 * 3 * 3 * 2.9 * 15 * 1e-6
    assert RELAY.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)


def test_the_load_factor_is_an_exponential(factors):
    """The 2020 tool took (S/d)² + 1: for a lamp at S = 0.4 a tenth of the printed 54.6."""
    inputs = RELAY.settle({**PLAIN, "load": "lamp", "load_current": "0.4 A"})
    assert factors(RELAY, inputs)["πL"] == pytest.approx(54.6, rel=0.001)


@pytest.mark.parametrize(
    ("quality", "cycling", "printed"),
    [("M", 0, 0.1), ("MIL-SPEC", 0.5, 0.1), ("R", 1, 0.1), ("M", 10, 1.0), ("M", 1500, 150.0), ("commercial", 5, 1.0),
     ("commercial", 10, 1.0), ("commercial", 150, 15.0), ("commercial", 1000, 100.0), ("commercial", 1500, 225.0)],
)  # fmt: skip
def test_cycling_by_quality(quality, cycling, printed, factors):
    inputs = RELAY.settle({**PLAIN, "quality": quality, "cycling": f"{cycling} cycle/h"})
    assert factors(RELAY, inputs)["πCYC"] == pytest.approx(printed, rel=1e-15)


def test_overstress_is_refused_in_a_design_and_flagged_live():
    with pytest.raises(ModelError, match=r"πL is outside the handbook's range: resistive load, stress S = 1\.5 of at"):
        RELAY.settle({**PLAIN, "load_current": "1.5 A"})
    design = RELAY.settle({**PLAIN, "load": "lamp"})
    value, extrapolated = RELAY.evaluate({**design, "load_current": np.array([-2.0, 0.4, 1.0, 1.01, 900.0])})
    assert extrapolated.tolist() == [True, False, False, True, True]
    assert np.all(np.isfinite(value))
    assert value[2] == value[3] == value[4]


def test_the_ambient_temperature_is_at_most_the_rated_one():
    with pytest.raises(ModelError, match="λb is outside the handbook's range: rated 85 °C"):
        RELAY.settle({**PLAIN, "rated_temperature": "85 degC", "temperature": "86 degC"})
    design = RELAY.settle({**PLAIN, "rated_temperature": "85 degC"})
    assert RELAY.evaluate({**design, "temperature": np.array([85.0, 85.1])}).extrapolated.tolist() == [False, True]


def test_no_relay_is_fired_from_a_cannon():
    with pytest.raises(ModelError, match="environment 'CL' is not one of its choices"):
        RELAY.settle({**PLAIN, "environment": "CL"})
