"""MIL-HDBK-217F Notice 2 §20.1, lamps: by hand."""

import pytest
from tests.cases import each_case

from robophm.hazard.handbooks import handbook_model

LAMP = handbook_model("mil_hdbk_217f.lamp")


@each_case(("share", "printed"), [(0, 0.1), (0.099, 0.1), (0.1, 0.72), (0.9, 0.72), (0.901, 1.0), (1, 1.0)])
def test_by_hand(share, printed):
    inputs = LAMP.settle({"rated_voltage": "12 V", "utilisation": share, "supply": "dc", "environment": "GM"})
    assert LAMP.evaluate(inputs).value == pytest.approx(0.074 * 12**1.29 * printed * 3.3 * 3e-6, rel=1e-14)
