"""MIL-HDBK-217F Notice 2 §15.2, sockets: by hand."""

import math

import pytest

from robophm.hazard.handbooks import handbook_model

SOCKET = handbook_model("mil_hdbk_217f.connector_socket")
PLAIN = {"style": "IC", "contacts": 1, "quality": "lower", "environment": "GB"}


def test_worked_by_hand():
    """40 contacts of a DIP in GM, lower quality: 0.00064 · exp(3.9^0.39) · 1 · 14."""
    inputs = SOCKET.settle({"style": "DIP", "contacts": 40, "environment": "GM"})
    assert SOCKET.evaluate(inputs).value == pytest.approx(0.00064 * math.exp(3.9**0.39) * 14e-6, rel=1e-14)
