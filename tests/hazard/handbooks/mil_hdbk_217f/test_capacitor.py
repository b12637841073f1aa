"""MIL-HDBK-217F Notice 2 §10.1, capacitors: by hand, at the limits of its bands and of stress."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f import handbook_arrhenius
from robophm.hazard.handbooks.mil_hdbk_217f.capacitor import STYLE

CAPACITOR = handbook_model("mil_hdbk_217f.capacitor")
PLAIN = {
    "capacitance": "1 uF",
    "temperature": "25 degC",
    "dc_voltage": "0.5 V",
    "rated_voltage": "1 V",
    "series_resistance": "1 ohm/V",
    "environment": "GB",
}


def factors(inputs):
    return {factor.symbol: float(np.asarray(factor.value)) for factor in CAPACITOR.explain(inputs).leaves()}


def test_worked_by_hand():
    """CDR, 0.1 µF, 60 °C, S = 0.5, commercial, GM: 0.0020 · 4.1895 · 0.1^0.09 · (1 + (5/6)³) · 10 · 20."""
    inputs = CAPACITOR.settle({
        "style": "CDR", "capacitance": "100 nF", "temperature": "60 degC", "dc_voltage": "8 V",
        "rated_voltage": "16 V", "environment": "GM",
    })  # fmt: skip
    pi_t = math.exp(0.35 / 8.617e-5 * (1 / 298 - 1 / 333))
    expected = 0.0020 * pi_t * 0.1**0.09 * (1 + (5 / 6) ** 3) * 10 * 20 * 1e-6
    assert CAPACITOR.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)


@each_case(
    ("resistance", "printed"),
    [(0.81, 0.66), (0.8, 1.0), (0.61, 1.0), (0.6, 1.3), (0.4, 2.0), (0.2, 2.7), (0.1, 3.3), (0.05, 3.3), (5, 0.66)],
)
def test_series_resistance_bands_are_printed_as_greater_than(resistance, printed):
    inputs = {"style": "CSR", **PLAIN, "series_resistance": f"{resistance} ohm/V"}
    assert factors(CAPACITOR.settle(inputs))["πSR"] == printed


@each_case("style", STYLE)
def test_only_solid_tantalum_asks_for_the_series_resistance(style):
    inputs = {key: value for key, value in PLAIN.items() if key != "series_resistance"}
    if style in ("CSR", "CWR"):
        with pytest.raises(ModelError, match=f"style {style} needs 'series_resistance'"):
            CAPACITOR.settle({"style": style, **inputs})
    else:
        assert factors(CAPACITOR.settle({"style": style, **inputs}))["πSR"] == 1


def test_ac_counts_by_its_peak():
    inputs = {"style": "CDR", **PLAIN, "rated_voltage": "10 V"}
    together = CAPACITOR.settle({**inputs, "dc_voltage": "5 V", "ac_voltage": "2 V"})
    peak = CAPACITOR.settle({**inputs, "dc_voltage": f"{5 + 2 * 2**0.5} V"})
    assert CAPACITOR.evaluate(together).value == pytest.approx(CAPACITOR.evaluate(peak).value, rel=1e-14)


def test_overstress_is_refused_in_a_design_and_flagged_live():
    inputs = {"style": "CDR", **PLAIN, "rated_voltage": "10 V"}
    with pytest.raises(ModelError, match="the applied voltage 12 V is more than the rated voltage 10 V: outside"):
        CAPACITOR.settle({**inputs, "dc_voltage": "12 V"})
    with pytest.raises(ModelError, match="outside"):
        CAPACITOR.settle({**inputs, "dc_voltage": "8 V", "ac_voltage": "2 V"})
    design = CAPACITOR.settle({**inputs, "dc_voltage": "10 V"})
    value, extrapolated = CAPACITOR.evaluate({**design, "dc_voltage": np.array([5.0, 10.0, 10.01, 30.0])})
    assert extrapolated.tolist() == [False, False, True, True]
    assert np.all(np.diff(value) > 0)


def test_reversed_polarity_and_broken_sensors_give_no_negative_rate():
    design = CAPACITOR.settle({"style": "CDR", **PLAIN, "rated_voltage": "10 V"})
    for name, values in (("dc_voltage", [-30.0, -10.0, -0.01]), ("temperature", [-1000.0, -273.0, -60.0])):
        value, extrapolated = CAPACITOR.evaluate({**design, name: np.array(values)})
        assert np.all(value >= 0), name
        assert np.all(value < 1e-3), name
        assert np.all(extrapolated)


def test_a_measured_input_that_the_style_does_not_use_changes_nothing():
    design = CAPACITOR.settle({"style": "CDR", **PLAIN})
    value, extrapolated = CAPACITOR.evaluate({**design, "series_resistance": np.array([0.1, 1.0, -1.0])})
    assert value.tolist() == [float(CAPACITOR.evaluate(design).value)] * 3
    assert extrapolated.tolist() == [False, False, True]


def test_the_handbook_rounds_its_physics():
    assert handbook_arrhenius(25.0, 0.35) == 1
    assert handbook_arrhenius(75.0, 0.35) == pytest.approx(math.exp(0.35 / 8.617e-5 * (1 / 298 - 1 / 348)), rel=1e-15)
