"""MIL-HDBK-217F Notice 2 §14.1 against Appendix A."""

import json
import math
from pathlib import Path

import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.switch import CONTACTS, ENVIRONMENT, QUALITY, STYLE

CASES = json.loads((Path(__file__).parents[3] / "data" / "switch.json").read_text())["cases"]
SWITCH = handbook_model("mil_hdbk_217f.switch")
PLAIN = {
    "style": "toggle", "contact_form": "SPST", "load": "resistive", "load_current": "0 A", "rated_current": "1 A",
    "quality": "MIL-SPEC", "environment": "GB",
}  # fmt: skip


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "type":
                ours["style"] = value
            case "S":
                ours |= {"load_current": f"{value} A", "rated_current": "1 A"}
            case "contacts":
                ours["contact_form"] = next(form for form, number in CONTACTS.items() if number == value)
            case "quality" | "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    answers(SWITCH, case, {**PLAIN, **given(case["inputs"])})


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 9
    as_published(CASES, "14.1")


def test_tables_agree_row_by_row(second):
    theirs = second("switches")
    assert {style.lower(): value for style, value in STYLE.items()} == theirs["lambda_b"]
    assert dict(QUALITY) == theirs["piQ"]
    assert dict(ENVIRONMENT) == theirs["piE"]
    words = theirs["piC"].partition("Nc ")[2].partition(";")[0].replace(",", "").split()
    words = words[words.index("SPST") :]
    assert {form: float(number) for form, number in zip(words[::2], words[1::2], strict=True)} == dict(CONTACTS)


def test_worked_by_hand():
    """DPDT pushbutton, inductive 2 A of 5 A, lower quality, GM: 0.10 · e · 4^0.33 · 2 · 18."""
    inputs = SWITCH.settle({
        "style": "button", "contact_form": "DPDT", "load": "inductive", "load_current": "2 A",
        "rated_current": "5 A", "environment": "GM",
    })  # fmt: skip
    assert SWITCH.evaluate(inputs).value == pytest.approx(0.1 * math.e * 4**0.33 * 2 * 18e-6, rel=1e-14)


@pytest.mark.parametrize("style", STYLE)
def test_contacts_count_for_toggles_and_pushbuttons_alone(style, factors):
    inputs = {**PLAIN, "style": style, "contact_form": "6PDT"}
    expected = 12**0.33 if style in ("toggle", "pushbutton") else 1
    assert factors(SWITCH, SWITCH.settle(inputs))["πC"] == pytest.approx(expected, rel=1e-15)
    del inputs["contact_form"]
    if expected == 1:
        SWITCH.settle(inputs)
    else:
        with pytest.raises(ModelError, match=f"style {style} needs 'contact_form'"):
            SWITCH.settle(inputs)
