"""MIL-HDBK-217F Notice 2 §5.5, hybrids: by hand."""

import math

import pytest

from robophm.hazard.handbooks import handbook_model

HYBRID = handbook_model("mil_hdbk_217f.microcircuit.hybrid")


def test_by_hand():
    inputs = HYBRID.settle({
        "component_rate": "0.1 FPMH", "function": "power", "years_in_production": "1 year", "environment": "GM",
    })  # fmt: skip
    expected = 0.1e-6 * (1 + 0.2 * 4) * 21 * 10 * 0.01 * math.exp(5.0)
    assert HYBRID.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)
