"""MIL-HDBK-217F Notice 2 §16.1 against Appendix A and the second transcription."""

import json
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.printed_board import ENVIRONMENT, QUALITY, TECHNOLOGY

CASES = json.loads((Path(__file__).parents[3] / "data" / "printed_board.json").read_text())["cases"]
BOARD = handbook_model("mil_hdbk_217f.printed_board")


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "lambda_b":
                ours["technology"] = {"printed_wiring_board": "printed"}[value]
            case "N1":
                ours["automated_holes"] = value
            case "N2":
                ours["hand_soldered_holes"] = value
            case "planes" | "quality" | "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    answers(BOARD, case, given(case["inputs"]))


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 1
    as_published(CASES, "16.1")


def test_tables_agree_row_by_row(second):
    theirs = second("interconnection")["pth_16_1"]
    assert list(TECHNOLOGY.values()) == list(theirs["lambda_b"].values())
    assert list(QUALITY.values()) == list(theirs["piQ"].values())
    assert dict(ENVIRONMENT) == theirs["piE"]


def test_by_hand():
    """12 planes, 500 and 30 holes, lower quality, GM; discrete wiring has πC 1 and asks for no planes."""
    inputs = {"automated_holes": 500, "hand_soldered_holes": 30, "environment": "GM"}
    printed = BOARD.settle({**inputs, "technology": "printed", "planes": 12})
    complexity = 0.65 * 12**0.63
    expected = 1.7e-5 * (500 * complexity + 30 * (complexity + 13)) * 2 * 7 * 1e-6
    assert BOARD.evaluate(printed).value == pytest.approx(expected, rel=1e-14)
    discrete = BOARD.settle({**inputs, "technology": "discrete"})
    assert BOARD.evaluate(discrete).value == pytest.approx(1.1e-4 * (500 + 30 * 14) * 14e-6, rel=1e-14)
    with pytest.raises(ModelError, match="a printed board needs 'planes'"):
        BOARD.settle({**inputs, "technology": "printed"})


def test_a_hole_by_hand_is_thirteen_more_than_one_by_machine():
    design = BOARD.settle({
        "technology": "discrete", "automated_holes": 1, "hand_soldered_holes": 0, "environment": "GB"
    })  # fmt: skip
    machine, hand = BOARD.evaluate({
        **design, "automated_holes": np.array([1, 0]), "hand_soldered_holes": np.array([0, 1])
    }).value  # fmt: skip
    assert hand / machine == pytest.approx(14, rel=1e-14)
