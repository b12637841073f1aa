"""MIL-HDBK-217F Notice 2 §11, coils and transformers: by hand, and the ways to a hot spot."""

import math

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.mil_hdbk_217f._inductive import NEEDS

PLAIN = {"kind": "fixed", "temperature": "25 degC", "temperature_rise": "0 K", "environment": "GB"}


def test_worked_by_hand(section):
    """A fixed coil at 40 °C, 20 K above it on average, lower quality, GM: hot spot at 40 + 1.1 · 20 = 62 °C."""
    inputs = {**PLAIN, "temperature": "40 degC", "temperature_rise": "20 K", "environment": "GM"}
    expected = 0.000030 * math.exp(0.11 / 8.617e-5 * (1 / 298 - 1 / 335)) * 3 * 12
    assert section("coil").rate(inputs) == pytest.approx(expected, rel=1e-14)


@each_case(
    ("given", "rise"),
    [
        ({"temperature_rise": "10 K"}, 10),
        ({"rise_from": "39010/5C"}, 15),
        ({"rise_from": "39010/11"}, 35),
        ({"rise_from": "case_area", "power_loss": "2 W", "case_area": f"{25 * 2.54**2} cm^2"}, 125 * 2 / 25),
        ({"rise_from": "case_area", "power_loss": "2 W", "case_area": "25 in^2"}, 125 * 2 / 25),
        ({"rise_from": "T27/FB", "power_loss": "2 W"}, 125 * 2 / 25),
        ({"rise_from": "weight", "power_loss": "2 W", "weight": "3 lb"}, 11.5 * 2 / 3**0.6766),
        ({"rise_from": "weight", "power_loss": "2 W", "weight": f"{3 * 0.45359237} kg"}, 11.5 * 2 / 3**0.6766),
        ({"rise_from": "input_power", "input_power": "30 W", "weight": "3 lb"}, 2.1 * 30 / 3**0.6766),
    ],
)
@each_case("name", ["coil", "transformer"])
def test_the_ways_to_a_hot_spot(name, given, rise, section):
    plain = {"kind": {"coil": "fixed", "transformer": "audio"}[name], "temperature": "30 degC", "environment": "GB"}
    expected = math.exp(0.11 / 8.617e-5 * (1 / 298 - 1 / (30 + 1.1 * rise + 273)))
    assert section(name).factors({**plain, **given})["πT"] == pytest.approx(expected, rel=1e-12)


@each_case("way", NEEDS)
@each_case("name", ["coil", "transformer"])
def test_one_way_to_the_hot_spot_is_required(way, name, section):
    plain = {"kind": {"coil": "fixed", "transformer": "audio"}[name], "temperature": "30 degC", "environment": "GB"}
    if NEEDS[way]:
        with pytest.raises(ModelError, match=f"rise_from {way} needs '{NEEDS[way][0]}'.*; other ways: case_area, "):
            section(name).rate({**plain, "rise_from": way})
    else:
        assert section(name).rate({**plain, "rise_from": way}) > 0


def test_a_hot_spot_beyond_the_table_is_refused_in_a_design_and_flagged_live(section):
    part = section("coil")
    with pytest.raises(
        ModelError, match="the temperature of the hot spot 210 °C is more than the handbook's 190 °C: outside"
    ):
        part.rate({**PLAIN, "temperature": "100 degC", "temperature_rise": "100 K"})
    design = part.model.settle({**PLAIN, "temperature_rise": "10 K"})
    value, extrapolated = part.model.evaluate({**design, "temperature": np.array([-300.0, 20.0, 179.0, 180.0, 191.0])})
    assert extrapolated.tolist() == [True, False, False, True, True]
    assert np.all(value >= 0)
