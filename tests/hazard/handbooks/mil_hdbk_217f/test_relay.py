"""MIL-HDBK-217F Notice 2 §13.1, relays: by hand, with their load and cycling."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

RELAY = handbook_model("mil_hdbk_217f.relay")
PLAIN = {
    "construction": "general-balanced-armature", "rated_temperature": "125 degC", "temperature": "25 degC",
    "load": "resistive", "load_current": "0 A", "rated_current": "1 A", "contact_form": "SPST",
    "cycling": "10 cycle/h", "quality": "M", "environment": "GB",
}  # fmt: skip


def test_worked_by_hand():
    """Inductive 2 A of 5 A, SPDT, 30 an hour, 60 °C of 125, general armature (long), commercial, GM."""
    inputs = RELAY.settle({
        "construction": "general-armature-long", "rated_temperature": "125", "temperature": "60 degC",
        "load": "inductive", "load_current": "2 A", "rated_current": "5 A", "contact_form": "SPDT",
        "cycling": "30 cycle/h", "environment": "GM",
    })  # fmt: skip
    base = 0.0059 * math.exp(-0.17 / 8.617e-5 * (1 / 333 - 1 / 298))
    expected = base * math.e * 1.75 * 3 * 3 * 2.9 * 15 * 1e-6
    assert RELAY.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)


def test_the_load_factor_is_an_exponential(factors):
    """The 2020 tool took (S/d)² + 1: for a lamp at S = 0.4 a tenth of the printed 54.6."""
    inputs = RELAY.settle({**PLAIN, "load": "lamp", "load_current": "0.4 A"})
    assert factors(RELAY, inputs)["πL"] == pytest.approx(54.6, rel=0.001)


@each_case(
    ("quality", "cycling", "printed"),
    [("M", 0, 0.1), ("MIL-SPEC", 0.5, 0.1), ("R", 1, 0.1), ("M", 10, 1.0), ("M", 1500, 150.0), ("commercial", 5, 1.0),
     ("commercial", 10, 1.0), ("commercial", 150, 15.0), ("commercial", 1000, 100.0), ("commercial", 1500, 225.0)],
)  # fmt: skip
def test_cycling_by_quality(quality, cycling, printed, factors):
    inputs = RELAY.settle({**PLAIN, "quality": quality, "cycling": f"{cycling} cycle/h"})
    assert factors(RELAY, inputs)["πCYC"] == pytest.approx(printed, rel=1e-15)


def test_overstress_is_refused_in_a_design_and_flagged_live():
    with pytest.raises(
        ModelError, match=r"the load current 1\.5 A is more than the rated current 1 A: outside the handbook's range"
    ):
        RELAY.settle({**PLAIN, "load_current": "1.5 A"})
    design = RELAY.settle({**PLAIN, "load": "lamp"})
    value, extrapolated = RELAY.evaluate({**design, "load_current": np.array([-2.0, 0.4, 1.0, 1.01, 900.0])})
    assert extrapolated.tolist() == [True, False, False, True, True]
    assert np.all(np.isfinite(value))
    assert value[2] == value[3] == value[4]


def test_the_ambient_temperature_is_at_most_the_rated_one():
    with pytest.raises(
        ModelError, match="the ambient temperature 86 °C is more than the rated temperature 85 °C: outside"
    ):
        RELAY.settle({**PLAIN, "rated_temperature": "85 degC", "temperature": "86 degC"})
    design = RELAY.settle({**PLAIN, "rated_temperature": "85 degC"})
    assert RELAY.evaluate({**design, "temperature": np.array([85.0, 85.1])}).extrapolated.tolist() == [False, True]


def test_no_relay_is_fired_from_a_cannon():
    with pytest.raises(ModelError, match="environment 'CL' is not one of its choices"):
        RELAY.settle({**PLAIN, "environment": "CL"})
