"""The figures of grade B, each reckoned anew from the numbers that its statement has, by the rule that it names."""

import json
import math

import pytest

from robophm.core.units import quantity
from robophm.design.file import parse
from robophm.parts import FIGURES, library

YEAR = 8760
MILLION = 1e6


def rolling(exponent, *factors):
    """Hours at a tenth of the dynamic rating and 1000 turns a minute: 10⁶/(60 n) · (C/P)^p, over service factors."""
    return 10**6 / (60 * 1000) * 10**exponent / math.prod(factors)


def mated_pair(base, temperature, matings):
    """Failures in 10⁶ h of a connector of lower quality (2) in ground mobile (8), MIL-HDBK-217F N2 §15.1."""
    return base * temperature * matings * 2 * 8


def warmed(kelvin, celsius):
    """Temperature factor of an optoelectronic device: exp(−kelvin · (1/T − 1/298)), MIL-HDBK-217F N2 §6.11."""
    return math.exp(-kelvin * (1 / (celsius + 273) - 1 / 298))


RECKONED = {  # in hours, cycles or starts until a tenth or a mean has failed; of a rate in failures in 10⁶ h
    "ball_bearing": rolling(3, 1.5, 1.8),
    "roller_bearing": rolling(3.3, 1.0, 1.8),
    "linear_rail": 50e3 * 10**3 / 0.5 / (1.5 * 1.8),
    "ball_screw": 1e6 * 10**3 / (2 * 250 / 5) / (1.5 * 1.8),
    "industrial_pc": 1 / (1 / 565_206 + 1 / 227_731),
    "safety_controller": 306 / 2 * YEAR,
    "connector": mated_pair(0.046, 1.3, 2.0),
    "connector_circular": mated_pair(0.0010, 1.3, 1.5),
    "connector_ethernet": mated_pair(0.0075, 1.3, 1.5),
    "connector_power": mated_pair(0.0070, 1.8, 3.0),
    "connector_usb": mated_pair(0.046, 1.3, 3.0),
    "strain_wave_gear_small": 15_000 / 5,
    "gripper_pneumatic": 5e6 / 2,
    "pneumatic_cylinder": 15e6 / 2,
    "rodless_cylinder": 25e6 / 2,
    "emergency_stop": 250_000 / 2,
    "enabling_switch": 100_000 / 2,
    "safety_bumper": 4.0e6 / 2,
    "hose": 6 * YEAR,
    "hydraulic_valve": 150 / 2 * YEAR,
    "inductive_sensor": 750 / 2 * YEAR,
    "photoelectric_sensor": 800 / 2 * YEAR,  # the lesser of two makers
    "lidar_2d_industrial/electronics": 100 / 2 * YEAR,
    "lidar_2d_industrial/motor and bearing": 20 * YEAR,
    "ups/electronics": 40_000,
    "ups/battery": 5 * YEAR,
    "bldc_motor/winding": 1.75 * 1.5 + 0.13 / (1.1 * 501_000) * MILLION,
    "bldc_motor/bearings": 20_000,
    "line_sensor/emitters": 8 * 0.0013 * warmed(2790, 65) * 8 * 8,
    "line_sensor/receivers": 8 * 0.0055 * warmed(2790, 65) * 8 * 8,
    "led": 0.00023 * warmed(2790, 65) * 8 * 8,
    "resolver": 1.2,
    "circuit_breaker": 0.34 * 15,
    "fuse": 0.010 * 8,
    "solid_state_relay": 0.029 * 1.9 * 12,
    "accelerometer": 15,
    "infrared_sensor": 7.5,
    "motion_detector": 7.5,
    "humidity_sensor": 20.44,
    "load_cell": 23,
    "smoke_sensor": 6.5,
    "temperature_sensor": 1.5,
    "seal_dynamic": 22.8,
    "seal_static": 2.4,
    "spring": 23.8 / 10,
    "pulley": 1.5,
    "v_belt": 40 + 2 * 1.5,
}


def test_every_entry_of_grade_b_is_reckoned():
    stated = set()
    for name, entry in library().items():
        if entry.grade == "B":
            stated |= {f"{name}/{mode}" for mode in entry.part.get("failure_modes", ())} or {name}
    assert stated == RECKONED.keys()


@pytest.mark.parametrize("mode", RECKONED)
def test_its_figure_follows_from_its_statement(mode):
    """To the two digits that figures are given with."""
    name, _, of = mode.partition("/")
    entry = library()[name]
    said = entry.part["failure_modes"][of] if of else entry.part
    (key,) = said.keys() & {*FIGURES, "hazard"}
    if key == "hazard":
        robot = parse(
            json.dumps({"schema_version": 1, "name": "R", "components": {"P": {"part": name}}, **place(entry)})
        )
        figure = robot.modes[0].rate * MILLION
    elif key == "rate":
        figure = quantity(said["rate"], "1/h") * MILLION
    else:
        figure = float(said[key].split()[0])
    assert figure == pytest.approx(RECKONED[mode], rel=0.03)


def place(entry):
    """The environment that an entry is stated for, if any."""
    return {"environment": entry.part["environment"]} if "environment" in entry.part else {}
