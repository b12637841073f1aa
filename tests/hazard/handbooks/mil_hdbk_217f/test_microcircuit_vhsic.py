"""MIL-HDBK-217F Notice 2 §5.3, VHSIC and VLSI CMOS: by hand."""

import math

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

VHSIC = handbook_model("mil_hdbk_217f.microcircuit.vhsic")
PLAIN = {
    "style": "logic", "die_area": "0.21 cm^2", "feature_size": "2 um", "package": "PGA-hermetic", "pins": 100,
    "power": "1 W", "case_temperature": "25 degC", "environment": "GM",
}  # fmt: skip


def test_by_hand():
    """πCD is 1 at 0.21 cm² and 2 µm; 10 K/W of a large die; quality unknown, process not qualified."""
    pi_t = 0.1 * math.exp(-0.35 / 8.617e-5 * (1 / (35 + 273) - 1 / 298))
    overstress = -math.log(1 - 0.00057) / 0.00876
    expected = 0.16 * 2.0 * pi_t * 1.0 + (0.0022 + 1.72e-5 * 100) * 4 * 10 * 2.2 + overstress
    assert VHSIC.evaluate(VHSIC.settle(PLAIN)).value == pytest.approx(expected * 1e-6, rel=1e-14)


@each_case(("volts", "printed"), [(0, 0.065), (1000, 0.053), (2000, 0.044), (4000, 0.029), (16000, 0.0027)])
def test_electrical_overstress_at_the_lower_ends_of_the_printed_classes(volts, printed, factors):
    """The five values of the printed table, from memory."""
    inputs = VHSIC.settle({**PLAIN, "discharge_threshold": f"{volts} V"})
    assert factors(VHSIC, inputs)["λEOS"] == pytest.approx(printed, rel=0.02)


def test_a_small_die_heats_more(factors):
    inputs = {**PLAIN, "die_area": "0.05 cm^2"}
    assert factors(VHSIC, VHSIC.settle(inputs))["πT"] == pytest.approx(
        0.1 * math.exp(-0.35 / 8.617e-5 * (1 / (45 + 273) - 1 / 298)), rel=1e-14
    )


def test_features_of_today_have_no_model():
    with pytest.raises(ModelError, match=r"feature_size 0\.04 um is outside"):
        VHSIC.settle({**PLAIN, "feature_size": "40 nm"})
