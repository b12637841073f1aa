"""MIL-HDBK-217F Notice 2 §17.1: no published answers, so the second transcription row by row."""

import pytest

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.connection import ENVIRONMENT, KIND

CONNECTION = handbook_model("mil_hdbk_217f.connection")


def test_tables_agree_row_by_row(second):
    theirs = second("interconnection")["connections_17_1"]
    assert dict(KIND) == {key.replace("_", "-"): value for key, value in theirs["lambda_b"].items()}
    assert dict(ENVIRONMENT) == theirs["piE"]


@pytest.mark.parametrize(
    ("kind", "rate"),
    [("terminal-block", 0.062), ("spring-contact", 0.17), ("reflow", 0.000069), ("hand solder", 0.0013)],
)
def test_by_hand(kind, rate):
    inputs = CONNECTION.settle({"kind": kind, "environment": "GM"})
    assert CONNECTION.evaluate(inputs).value == pytest.approx(rate * 7e-6, rel=1e-14)
