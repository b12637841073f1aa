"""MIL-HDBK-217F Notice 2 §14.1, switches: by hand."""

import math

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.switch import STYLE

SWITCH = handbook_model("mil_hdbk_217f.switch")
PLAIN = {
    "style": "toggle", "contact_form": "SPST", "load": "resistive", "load_current": "0 A", "rated_current": "1 A",
    "quality": "MIL-SPEC", "environment": "GB",
}  # fmt: skip


def test_worked_by_hand():
    """DPDT pushbutton, inductive 2 A of 5 A, lower quality, GM: 0.10 · e · 4^0.33 · 2 · 18."""
    inputs = SWITCH.settle({
        "style": "button", "contact_form": "DPDT", "load": "inductive", "load_current": "2 A",
        "rated_current": "5 A", "environment": "GM",
    })  # fmt: skip
    assert SWITCH.evaluate(inputs).value == pytest.approx(0.1 * math.e * 4**0.33 * 2 * 18e-6, rel=1e-14)


@each_case("style", STYLE)
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
