"""MIL-HDBK-217F Notice 2 §20.1 against Appendix A and the second transcription."""

import json
from pathlib import Path

import pytest

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.lamp import ENVIRONMENT, SUPPLY, UTILISATION

CASES = json.loads((Path(__file__).parents[3] / "data" / "lamp.json").read_text())["cases"]
LAMP = handbook_model("mil_hdbk_217f.lamp")


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "V_rated":
                ours["rated_voltage"] = f"{value} V"
            case "utilization":
                ours["utilisation"] = value
            case "application":
                ours["supply"] = value
            case "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    answers(LAMP, case, given(case["inputs"]))


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 1
    as_published(CASES, "20.1")


def test_tables_agree_row_by_row(second):
    theirs = second("crystals_fuses_lamps_filters_meters")["lamp"]
    assert dict(SUPPLY) == theirs["piA"]
    assert dict(ENVIRONMENT) == theirs["piE"]
    assert list(UTILISATION) == [row[1] for row in theirs["piU"]]


@pytest.mark.parametrize(
    ("share", "printed"), [(0, 0.1), (0.099, 0.1), (0.1, 0.72), (0.9, 0.72), (0.901, 1.0), (1, 1.0)]
)
def test_by_hand(share, printed):
    inputs = LAMP.settle({"rated_voltage": "12 V", "utilisation": share, "supply": "dc", "environment": "GM"})
    assert LAMP.evaluate(inputs).value == pytest.approx(0.074 * 12**1.29 * printed * 3.3 * 3e-6, rel=1e-14)
