"""MIL-HDBK-217F Notice 2 §14.2 against Appendix A."""

import json
from pathlib import Path

import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.circuit_breaker import ENVIRONMENT, POLES, QUALITY, USE

CASES = json.loads((Path(__file__).parents[3] / "data" / "circuit_breaker.json").read_text())["cases"]
BREAKER = handbook_model("mil_hdbk_217f.circuit_breaker")


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "poles":
                ours["poles"] = str(value)
            case "usage":
                ours["use"] = {"not power switch": "breaker-only"}[value]
            case "quality" | "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    answers(BREAKER, case, given(case["inputs"]))


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 9
    as_published(CASES, "14.2")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("switches")["breaker"]
    assert list(POLES.values()) == [1, 2, 3, 4]
    assert list(USE.values()) == list(theirs["piU"].values())
    assert dict(QUALITY) == theirs["piQ"]
    assert dict(ENVIRONMENT) == {key: value for key, value in theirs["piE"].items() if value is not None}
    plain = BREAKER.settle({"poles": "SPST", "use": "breaker-only", "environment": "GB"})
    assert factors(BREAKER, plain)["λb"] == theirs["lambda_b"]


def test_worked_by_hand():
    inputs = BREAKER.settle({"poles": "3PST", "use": "also-switch", "environment": "GM"})
    assert BREAKER.evaluate(inputs).value == pytest.approx(0.34 * 3 * 2.5 * 8.4 * 15e-6, rel=1e-14)


def test_no_breaker_is_fired_from_a_cannon():
    with pytest.raises(ModelError, match="environment 'CL' is not one of its choices"):
        BREAKER.settle({"poles": "SPST", "use": "breaker-only", "environment": "CL"})
