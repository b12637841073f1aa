"""MIL-HDBK-217F Notice 2 §22.1 against Appendix A."""

import json
from pathlib import Path

import pytest

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.fuse import ENVIRONMENT

CASES = json.loads((Path(__file__).parents[3] / "data" / "fuse.json").read_text())["cases"]
FUSE = handbook_model("mil_hdbk_217f.fuse")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    assert case["inputs"].keys() == {"environment"}
    answers(FUSE, case, case["inputs"])


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 10
    as_published(CASES, "22.1")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("crystals_fuses_lamps_filters_meters")["fuse"]
    assert dict(ENVIRONMENT) == theirs["piE"]
    assert factors(FUSE, {"environment": "GB"})["λb"] == theirs["lambda_b"]


def test_a_robot_is_not_fired_from_a_cannon():
    """The paper's resettable fuse has the factor of cannon launch, 230; a fuse of a mobile robot is 8e-8 /h."""
    assert FUSE.evaluate(FUSE.settle({"environment": "GM"})).value == pytest.approx(8e-8, rel=1e-14)
