"""MIL-HDBK-217F Notice 2 §5.4, GaAs circuits: by hand."""

import math

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

GAAS = handbook_model("mil_hdbk_217f.microcircuit.gaas")
PLAIN = {
    "application": "digital", "elements": 1000, "package": "flatpack", "pins": 16, "power": "0 W",
    "case_temperature": "150 degC", "years_in_production": "2 year", "quality": "B", "environment": "GB",
}  # fmt: skip


def test_by_hand_at_the_reference():
    """150 °C is 423 K: πT 0.1, for digital and MMIC."""
    package = 3.0e-5 * 16**1.82 * 0.5
    assert GAAS.evaluate(GAAS.settle(PLAIN)).value == pytest.approx((25 * 0.1 + package) * 1e-6, rel=1e-14)
    driver = GAAS.settle({**PLAIN, "application": "MMIC", "elements": 101})
    assert GAAS.evaluate(driver).value == pytest.approx((7.2 * 0.1 * 3 + package) * 1e-6, rel=1e-14)
    cold = GAAS.settle({**PLAIN, "case_temperature": "65 degC"})
    pi_t = 0.1 * math.exp(-1.4 / 8.617e-5 * (1 / 338 - 1 / 423))
    assert GAAS.evaluate(cold).value == pytest.approx((25 * pi_t + package) * 1e-6, rel=1e-14)


def test_a_larger_mmic_has_no_model():
    with pytest.raises(ModelError, match="1001 elements are more than the 1000 that the handbook has of MMIC: outside"):
        GAAS.settle({**PLAIN, "application": "MMIC", "elements": 1001})
    assert not np.any(GAAS.evaluate(GAAS.settle({**PLAIN, "elements": 10000})).extrapolated)
