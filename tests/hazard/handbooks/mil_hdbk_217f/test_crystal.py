"""MIL-HDBK-217F Notice 2 §19.1, quartz crystals: the unit of their frequency."""

import pytest

from robophm.core.errors import ModelError, UnitError
from robophm.hazard.handbooks import handbook_model

CRYSTAL = handbook_model("mil_hdbk_217f.crystal")
PLAIN = {"frequency": "1 MHz", "quality": "MIL-SPEC", "environment": "GB"}


def test_the_frequency_is_in_megahertz():
    """The paper entered Hz: 24 times too much (10⁶ to the power of 0.23)."""
    rates = [
        CRYSTAL.evaluate(CRYSTAL.settle({**PLAIN, "frequency": f, "environment": "GF"})).value
        for f in ("16 MHz", "16000 kHz", "16000000 Hz")
    ]
    assert rates == pytest.approx([0.013 * 16**0.23 * 3e-6] * 3, rel=1e-14)
    assert 1.77e-6 / rates[0] == pytest.approx(24, rel=0.01)  # what the paper's Table 17 prints
    with pytest.raises(UnitError, match="has no unit"):
        CRYSTAL.settle({**PLAIN, "frequency": 16e6})
    with pytest.raises(ModelError, match="outside"):
        CRYSTAL.settle({**PLAIN, "frequency": "16e6 MHz"})


def test_a_watch_crystal_is_below_the_printed_table():
    inputs = CRYSTAL.settle({"frequency": "32.768 kHz", "environment": "GB"})
    assert CRYSTAL.evaluate(inputs).value == pytest.approx(0.013 * 0.032768**0.23 * 2.1e-6, rel=1e-14)
