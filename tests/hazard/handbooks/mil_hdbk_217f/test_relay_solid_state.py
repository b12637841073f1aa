"""MIL-HDBK-217F Notice 2 §13.2: no published answers, so the second transcription row by row."""

import pytest

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.relay_solid_state import ENVIRONMENT, QUALITY

RELAY = handbook_model("mil_hdbk_217f.relay_solid_state")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("relays")["ss_relay_13_2"]
    assert dict(QUALITY) == theirs["piQ"]
    assert dict(ENVIRONMENT) == theirs["piE"]
    assert factors(RELAY, {"quality": "MIL-SPEC", "environment": "GB"})["λb"] == theirs["lambda_b"]


def test_worked_by_hand():
    assert RELAY.evaluate(RELAY.settle({"environment": "GM"})).value == pytest.approx(0.029 * 1.9 * 12e-6, rel=1e-14)
