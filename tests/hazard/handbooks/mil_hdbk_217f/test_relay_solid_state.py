"""MIL-HDBK-217F Notice 2 §13.2, solid-state relays: by hand."""

import pytest

from robophm.hazard.handbooks import handbook_model

RELAY = handbook_model("mil_hdbk_217f.relay_solid_state")


def test_worked_by_hand():
    assert RELAY.evaluate(RELAY.settle({"environment": "GM"})).value == pytest.approx(0.029 * 1.9 * 12e-6, rel=1e-14)
