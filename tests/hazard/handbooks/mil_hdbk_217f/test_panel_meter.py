"""MIL-HDBK-217F Notice 2 §18.1, panel meters: by hand."""

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

METER = handbook_model("mil_hdbk_217f.panel_meter")


def test_by_hand():
    inputs = METER.settle({"application": "ac", "function": "other", "environment": "GM"})
    assert METER.evaluate(inputs).value == pytest.approx(0.09 * 1.7 * 2.8 * 3.4 * 25e-6, rel=1e-14)


@each_case("environment", ["ML", "CL"])
def test_launches_have_no_model(environment):
    with pytest.raises(ModelError, match=f"environment '{environment}' is not one of its choices"):
        METER.settle({"application": "ac", "function": "other", "environment": environment})
