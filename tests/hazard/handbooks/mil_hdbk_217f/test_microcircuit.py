"""MIL-HDBK-217F Notice 2 §5.1 and what chapter 5 shares: by hand, and at the limits of its tables."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    FAMILY,
)

LOGIC, LINEAR, PROCESSOR, PROGRAMMABLE, MEMORY, VHSIC, GAAS, HYBRID = (
    handbook_model(f"mil_hdbk_217f.microcircuit.{name}")
    for name in ("logic", "linear", "processor", "programmable", "memory", "vhsic", "gaas", "hybrid")
)
CHIP = {
    "package": "DIP-hermetic", "pins": 14, "power": "0 W", "case_temperature": "25 degC",
    "years_in_production": "2 year", "quality": "B", "environment": "GB",
}  # fmt: skip


@each_case(
    ("model", "inputs", "expected"),
    [
        (LOGIC, {"family": "TTL", "gates": 100}, 0.0025), (LOGIC, {"family": "TTL", "gates": 101}, 0.005),
        (LOGIC, {"family": "CMOS", "gates": 60000}, 0.29), (LOGIC, {"family": "BiCMOS", "gates": 1}, 0.01),
        (LINEAR, {"transistors": 300}, 0.02), (LINEAR, {"transistors": 301}, 0.04),
        (PROCESSOR, {"family": "CMOS", "bits": "8 bit"}, 0.14), (PROCESSOR, {"family": "CMOS", "bits": "9 bit"}, 0.28),
        (PROCESSOR, {"family": "bipolar", "bits": "32 bit"}, 0.24),
        (PROGRAMMABLE, {"family": "MOS", "gates": 20000}, 0.0068),
        (PROGRAMMABLE, {"family": "TTL", "gates": 5000}, 0.042),
    ],
)  # fmt: skip
def test_complexity(model, inputs, expected, factors):
    assert factors(model, model.settle({**CHIP, **inputs}))["C1"] == expected


@each_case(
    ("model", "inputs", "message"),
    [
        (LOGIC, {"family": "CMOS", "gates": 60001}, "gates 60001 is outside 1 … 60000"),
        (LINEAR, {"transistors": 60001}, "transistors 60001 is outside 1 … 60000"),
        (PROCESSOR, {"family": "CMOS", "bits": "256 bit"}, "bits 256 bit is outside 1 … 128 bit"),
        (PROGRAMMABLE, {"family": "MOS", "gates": 60001}, "gates 60001 is outside 1 … 60000"),
    ],
)  # fmt: skip
def test_larger_circuits_have_no_model(model, inputs, message):
    with pytest.raises(ModelError, match=message):
        model.settle({**CHIP, **inputs})


def test_a_microcontroller_by_hand():
    """STM32F407: CMOS of 32 bits, 100 pins of plastic, 0.3 W at 50 °C in GM; C2 = 3.6e-4 · 100^1.08, θJC 20 K/W."""
    inputs = PROCESSOR.settle({
        "family": "CMOS", "bits": "32 bit", "package": "LQFP", "pins": 100, "power": "0.3 W",
        "years_in_production": "12 year", "environment": "GM",
    })  # fmt: skip
    pi_t = 0.1 * math.exp(-0.35 / 8.617e-5 * (1 / (50 + 20 * 0.3 + 273) - 1 / 298))
    expected = (0.56 * pi_t + 3.6e-4 * 100**1.08 * 4) * 10 * 1 * 1e-6
    assert PROCESSOR.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)


def test_temperature_factor_is_a_tenth_at_25_degrees(factors):
    for family in FAMILY:
        assert factors(LOGIC, LOGIC.settle({**CHIP, "family": family, "gates": 1}))["πT"] == 0.1
    assert factors(LINEAR, LINEAR.settle({**CHIP, "transistors": 1}))["πT"] == 0.1


@each_case(
    ("years", "expected"),
    [(0, 2.0), (0.1, 2.0), (0.5, 0.01 * math.exp(5.175)), (1, 0.01 * math.exp(5.0)), (2, 1.0), (30, 1.0)],
)
def test_learning(years, expected, factors):
    inputs = LINEAR.settle({**CHIP, "transistors": 1, "years_in_production": f"{years} year"})
    assert factors(LINEAR, inputs)["πL"] == pytest.approx(expected, rel=1e-15)


def test_custom_screening(factors):
    inputs = {**CHIP, "transistors": 1, "quality": "custom"}
    assert factors(LINEAR, LINEAR.settle({**inputs, "screening_points": 87}))["πQ"] == 3
    with pytest.raises(ModelError, match="quality custom needs 'screening_points'"):
        LINEAR.settle(inputs)


def test_the_junction_is_warmer_than_the_case(factors):
    inputs = {**CHIP, "transistors": 1, "power": "2 W"}

    def at(**others):
        return factors(LINEAR, LINEAR.settle({**inputs, **others}))["πT"]

    def junction(celsius):
        return 0.1 * math.exp(-0.65 / 8.617e-5 * (1 / (celsius + 273) - 1 / 298))

    assert at() == pytest.approx(junction(25 + 28 * 2), rel=1e-14)
    assert at(die="large") == pytest.approx(junction(25 + 11 * 2), rel=1e-14)
    assert at(thermal_resistance="5 K/W") == pytest.approx(junction(25 + 5 * 2), rel=1e-14)
    del inputs["case_temperature"]
    assert at(environment="GM", thermal_resistance="5 K/W") == pytest.approx(junction(50 + 5 * 2), rel=1e-14)
    with pytest.raises(ModelError, match="package can with a large die needs 'thermal_resistance'"):
        at(package="can", die="large")


def test_a_junction_that_is_too_hot_is_refused_in_a_design_and_flagged_live():
    with pytest.raises(
        ModelError, match="the temperature of the junction 305 °C is more than the handbook's 175 °C: outside"
    ):
        LINEAR.settle({**CHIP, "transistors": 1, "power": "10 W"})
    design = LINEAR.settle({**CHIP, "transistors": 1})
    assert LINEAR.evaluate({**design, "power": np.array([0.0, 5.0, 6.0])}).extrapolated.tolist() == [False, False, True]
