"""MIL-HDBK-217F Notice 2 §5.5 against the second transcription; its worked example is in test_microcircuit."""

import math
import re

import pytest

from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit.hybrid import FUNCTION

HYBRID = handbook_model("mil_hdbk_217f.microcircuit.hybrid")


def test_functions_agree_row_by_row(second):
    written = second("microcircuits")["hybrid_5_5"].partition("piF digital")[2]
    assert {name: float(number) for name, number in re.findall(r"(\w+) ([\d.]+)", "digital" + written)} == dict(
        FUNCTION
    )


def test_by_hand():
    inputs = HYBRID.settle({
        "component_rate": "0.1 FPMH", "function": "power", "years_in_production": "1 year", "environment": "GM",
    })  # fmt: skip
    expected = 0.1e-6 * (1 + 0.2 * 4) * 21 * 10 * 0.01 * math.exp(5.0)
    assert HYBRID.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)
