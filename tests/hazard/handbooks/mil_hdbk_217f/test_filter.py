"""MIL-HDBK-217F Notice 2 §21.1, filters: by hand."""

import pytest

from robophm.hazard.handbooks import handbook_model

FILTER = handbook_model("mil_hdbk_217f.filter")


def test_by_hand():
    inputs = FILTER.settle({"style": "discrete-LC-crystal", "environment": "GM"})
    assert FILTER.evaluate(inputs).value == pytest.approx(0.27 * 2.9 * 6e-6, rel=1e-14)
