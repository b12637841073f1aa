"""MIL-HDBK-217F Notice 2 §17.1, connections: by hand."""

import pytest
from tests.cases import each_case

from robophm.hazard.handbooks import handbook_model

CONNECTION = handbook_model("mil_hdbk_217f.connection")


@each_case(
    ("kind", "rate"),
    [("terminal-block", 0.062), ("spring-contact", 0.17), ("reflow", 0.000069), ("hand solder", 0.0013)],
)
def test_by_hand(kind, rate):
    inputs = CONNECTION.settle({"kind": kind, "environment": "GM"})
    assert CONNECTION.evaluate(inputs).value == pytest.approx(rate * 7e-6, rel=1e-14)
