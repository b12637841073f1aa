"""MIL-HDBK-217F Notice 2 §18.1: no published answers, so the second transcription row by row."""

import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.panel_meter import APPLICATION, ENVIRONMENT, FUNCTION, QUALITY

METER = handbook_model("mil_hdbk_217f.panel_meter")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("crystals_fuses_lamps_filters_meters")["panel_meter"]
    assert dict(APPLICATION) == theirs["piA"]
    assert dict(FUNCTION) == theirs["piF"]
    assert list(QUALITY.values()) == list(theirs["piQ"].values())
    assert dict(ENVIRONMENT) == {key: value for key, value in theirs["piE"].items() if value is not None}
    plain = METER.settle({"application": "dc", "function": "ammeter", "environment": "GB"})
    assert factors(METER, plain)["λb"] == theirs["lambda_b"]


def test_by_hand():
    inputs = METER.settle({"application": "ac", "function": "other", "environment": "GM"})
    assert METER.evaluate(inputs).value == pytest.approx(0.09 * 1.7 * 2.8 * 3.4 * 25e-6, rel=1e-14)


@pytest.mark.parametrize("environment", ["ML", "CL"])
def test_launches_have_no_model(environment):
    with pytest.raises(ModelError, match=f"environment '{environment}' is not one of its choices"):
        METER.settle({"application": "ac", "function": "other", "environment": environment})
