"""MIL-HDBK-217F Notice 2 §15.2 against Appendix A and the printed table of πP."""

import json
import math
from pathlib import Path

import pytest

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.connector_socket import ENVIRONMENT, QUALITY, STYLE

CASES = json.loads((Path(__file__).parents[3] / "data" / "connector_socket.json").read_text())["cases"]
SOCKET = handbook_model("mil_hdbk_217f.connector_socket")
PLAIN = {"style": "IC", "contacts": 1, "quality": "lower", "environment": "GB"}


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "pins" | "N":
                ours["contacts"] = value
            case "piQ":
                ours["quality"] = {0.3: "MIL-SPEC", 1.0: "lower"}[value]
            case "type":
                ours["style"] = value
            case "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    inputs = dict(case["inputs"])
    symbol = {None: None, "piP": "πP"}[inputs.pop("factor", None)]
    answers(SOCKET, case, {**PLAIN, **given(inputs)}, symbol)


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 43
    as_published(CASES, "15.2")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("connectors")
    assert list(STYLE.values()) == list(theirs["socket_lambda_b"].values())
    assert [name.split("_")[0] for name in list(theirs["socket_lambda_b"])[1:]] == list(STYLE)[1:]
    assert dict(QUALITY) == theirs["socket_piQ"]
    assert dict(ENVIRONMENT) == theirs["socket_piE"]
    for label, value in theirs["printed_piP"].items():
        found = factors(SOCKET, SOCKET.settle({**PLAIN, "contacts": int(label.removeprefix("numb_"))}))["πP"]
        assert found == pytest.approx(value, abs=0.55 if value >= 10 else 0.055), label


def test_worked_by_hand():
    """40 contacts of a DIP in GM, lower quality: 0.00064 · exp(3.9^0.39) · 1 · 14."""
    inputs = SOCKET.settle({"style": "DIP", "contacts": 40, "environment": "GM"})
    assert SOCKET.evaluate(inputs).value == pytest.approx(0.00064 * math.exp(3.9**0.39) * 14e-6, rel=1e-14)
