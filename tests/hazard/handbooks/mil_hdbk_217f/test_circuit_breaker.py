"""MIL-HDBK-217F Notice 2 §14.2, circuit breakers: by hand."""

import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

BREAKER = handbook_model("mil_hdbk_217f.circuit_breaker")


def test_worked_by_hand():
    inputs = BREAKER.settle({"poles": "3PST", "use": "also-switch", "environment": "GM"})
    assert BREAKER.evaluate(inputs).value == pytest.approx(0.34 * 3 * 2.5 * 8.4 * 15e-6, rel=1e-14)


def test_no_breaker_is_fired_from_a_cannon():
    with pytest.raises(ModelError, match="environment 'CL' is not one of its choices"):
        BREAKER.settle({"poles": "SPST", "use": "breaker-only", "environment": "CL"})
