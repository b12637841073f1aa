"""MIL-HDBK-217F Notice 2 §21.1 against Appendix A and the second transcription."""

import json
from pathlib import Path

import pytest

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.filter import ENVIRONMENT, QUALITY, STYLE

CASES = json.loads((Path(__file__).parents[3] / "data" / "filter.json").read_text())["cases"]
FILTER = handbook_model("mil_hdbk_217f.filter")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    assert case["inputs"].keys() == {"quality", "environment"}
    assert case["name"] == "appA_filter_ceramic_ferrite_GB"
    answers(FILTER, case, {"style": "ceramic-ferrite", **case["inputs"]})


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 1
    as_published(CASES, "21.1")


def test_tables_agree_row_by_row(second):
    theirs = second("crystals_fuses_lamps_filters_meters")["filter"]
    assert list(STYLE.values()) == list(theirs["lambda_b"].values())
    assert dict(QUALITY) == theirs["piQ"]
    assert dict(ENVIRONMENT) == theirs["piE"]


def test_by_hand():
    inputs = FILTER.settle({"style": "discrete-LC-crystal", "environment": "GM"})
    assert FILTER.evaluate(inputs).value == pytest.approx(0.27 * 2.9 * 6e-6, rel=1e-14)
