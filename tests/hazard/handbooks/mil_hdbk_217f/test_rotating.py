"""MIL-HDBK-217F Notice 2 §12, motors, synchros, elapsed-time meters: by hand, and at the limits of their bands."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError

MOTOR = {"kind": "electrical_general", "temperature": "50 degC", "design_life": "87600 h"}
SYNCHRO = {"kind": "synchro", "temperature": "25 degC", "size": 20, "brushes": 2, "environment": "GB"}
METER = {"kind": "ac", "temperature": "50 degC", "rated_temperature": "100 degC", "environment": "GB"}


def test_the_rate_is_per_hour_and_not_a_millionth_of_it(section):
    """The 2020 tool divides what is per hour by 10⁶ again, has A for B, and lets the user choose λ1 and λ2."""
    model = section("motor").model
    value = float(model.evaluate(model.settle({**MOTOR, "kind": "servo"})).value)
    bearing = 1 / (10 ** (2.534 - 2357 / 323) + 1 / (10 ** (20 - 4500 / 323) + 300))
    winding = 10 ** (2357 / 323 - 1.83)
    assert (87600 / bearing > 1, 0.2 < 87600 / winding <= 0.3) == (True, True)
    assert value == pytest.approx(1.0 / (2.4 * bearing) + 0.23 / (1.7 * winding), rel=1e-14)
    assert 1e-6 < value < 1e-4


@each_case(
    ("share", "expected"),
    [
        *[(0.0001, 0.13), (0.1, 0.13), (0.1001, 0.15), (0.2, 0.15), (0.3, 0.23), (0.4, 0.31), (0.5, 0.41)],
        *[(0.6, 0.51), (0.7, 0.61), (0.8, 0.68), (0.9, 0.76), (0.9001, 1.0), (1.0, 1.0), (50, 1.0)],
    ],
)
def test_effective_failures_follow_from_the_design_life(share, expected, section):
    winding = 10 ** (2357 / 323 - 1.83)
    found = section("motor").factors(MOTOR, design_life=share * winding * (1 - 1e-12))
    assert found["λ2"] == expected


def test_what_a_motor_needs(section):
    part = section("motor")
    with pytest.raises(ModelError, match="needs the input 'design_life'"):
        part.rate({key: value for key, value in MOTOR.items() if key != "design_life"})
    for temperature in (-1, 141):
        with pytest.raises(ModelError, match=r"temperature .* is outside 0 … 140 degC"):
            part.rate({**MOTOR, "temperature": f"{temperature} degC"})
    assert part.rate({**MOTOR, "design_life": "10 years"}) == pytest.approx(part.rate(MOTOR), rel=1e-12)
    values = np.array([-400.0, -20.0, 20.0, 1e6])
    value, extrapolated = part.model.evaluate({**part.model.settle(MOTOR), "temperature": values})
    assert extrapolated.tolist() == [True, True, False, True]
    assert np.all(np.isfinite(value))
    assert np.all(value > 0)


def test_frost_is_flagged_and_still_follows_the_formula(section):
    found = section("motor").factors(MOTOR, temperature=-20.0)
    bearing = 1 / (10 ** (2.534 - 2357 / 253) + 1 / (10 ** (20 - 4500 / 253) + 300))
    assert 1 / found["1/αB"] == pytest.approx(bearing, rel=1e-12)


def test_bearings_last_longest_near_35_degrees(section):
    temperatures = np.arange(0.0, 141.0)
    lives = 1 / section("motor").factors(MOTOR, temperature=temperatures)["1/αB"]
    assert 33 <= temperatures[np.argmax(lives)] <= 38


@each_case(
    ("kind", "size", "expected"),
    [
        *[("synchro", 8, 2), ("synchro", 10, 1.5), ("synchro", 16, 1.5), ("synchro", 18, 1), ("synchro", 31, 1)],
        *[("resolver", 5, 3), ("resolver", 11, 2.25), ("resolver", 23, 1.5)],
    ],
)
def test_size_of_a_synchro(kind, size, expected, section):
    assert section("synchro").factors({**SYNCHRO, "kind": kind, "size": size})["πS"] == expected


@each_case(("brushes", "expected"), [(0, 1.4), (1, 1.4), (2, 1.4), (3, 2.5), (4, 3.2)])
def test_brushes_of_a_synchro(brushes, expected, section):
    assert section("synchro").factors({**SYNCHRO, "brushes": brushes})["πN"] == expected


def test_a_synchro_worked_by_hand(section):
    """A resolver of size 11, frame 40 K above 20 °C where nothing is known, GM."""
    part = section("synchro")
    inputs = {**SYNCHRO, "kind": "resolver", "size": 11, "temperature": "20 degC", "environment": "GM"}
    expected = 0.00535 * math.exp((333 / 334) ** 8.5) * 2.25 * 1.4 * 12
    assert part.rate(inputs) == pytest.approx(expected, rel=1e-13)
    with pytest.raises(
        ModelError, match="the temperature of the frame 140 °C is more than the handbook's 135 °C: outside"
    ):
        part.rate({**inputs, "temperature": "100 degC"})
    with pytest.raises(ModelError, match="brushes 5 is outside"):
        part.rate({**inputs, "brushes": 5})
    design = part.model.settle(inputs)
    value, extrapolated = part.model.evaluate({**design, "temperature": np.array([-400.0, 95.0, 96.0, 1e6])})
    assert extrapolated.tolist() == [True, False, True, True]
    assert np.all(np.isfinite(value))


@each_case(
    ("celsius", "expected"), [(-20, 0.5), (50, 0.5), (51, 0.6), (60, 0.6), (61, 0.8), (80, 0.8), (81, 1), (100, 1)]
)
def test_temperature_of_a_meter(celsius, expected, section):
    assert section("elapsed_time_meter").factors({**METER, "temperature": f"{celsius} degC"})["πT"] == expected


def test_a_meter_worked_by_hand_and_its_limits(section):
    part = section("elapsed_time_meter")
    inputs = {**METER, "kind": "inverter", "temperature": "70 degC", "environment": "GM"}
    assert part.rate(inputs) == pytest.approx(30 * 0.8 * 12, rel=1e-14)
    with pytest.raises(
        ModelError, match="the operating temperature 101 °C is more than the rated temperature 100 °C: outside"
    ):
        part.rate({**METER, "temperature": "101 degC"})
    with pytest.raises(ModelError, match="environment 'CL' is not one of its choices"):
        part.rate({**METER, "environment": "CL"})
