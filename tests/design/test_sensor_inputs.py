"""A bound or stated stress reaches every input that follows from it: by how much each part is warmer, as designed."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import DesignError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import load, parse
from robophm.design.importers.bom import import_bom
from robophm.design.importers.bom.assumptions import Assumptions
from robophm.design.task_file import parse_plan
from robophm.hazard.acceleration import ACCELERATIONS
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import planned
from robophm.health.outlooks import as_lived
from robophm.health.plant import Plant

DATA = Path(__file__).parents[1] / "data"
HEAD = "schema_version: 1\nname: Board\nenvironment: GM\n"
NEVER_OPERATED_AT = {"rated_temperature", "reference_temperature"}
IN_STEPS = {"mil_hdbk_217f.elapsed_time_meter", "nswc_11.bearing", "nswc_11.bearing_rated_life", "nswc_11.shaft",
            "nswc_11.static_seal"}  # fmt: skip
"""The factor of temperature is printed in bands, or is 1 up to a temperature."""
SWINGS_AND_RISES = {"temperature_swing", "reference_temperature_swing", "temperature_rise", "frame_rise"}


def arrhenius(celsius, energy):
    return math.exp(-energy / 8.617e-5 * (1 / (celsius + 273) - 1 / 298))


def semiconductor(celsius, coefficient):
    return math.exp(-coefficient * (1 / (celsius + 273) - 1 / 298))


MIXED = """
modules:
  Board:
    signals: {temperature: {topic: /board, field: temperature, range: [-40, 150]}}
    components:
      Capacitor: {hazard: {model: mil_hdbk_217f.capacitor, inputs: {style: CDR, capacitance: 0.1 uF, dc_voltage: 5 V,
        rated_voltage: 10 V, temperature: 40 degC}}}
      Resistor: {hazard: {model: mil_hdbk_217f.resistor, inputs: {style: RM, power: 0.1 W, rated_power: 0.25 W,
        temperature: 60 degC}}}
      Coil: {hazard: {model: mil_hdbk_217f.coil, inputs: {kind: fixed, temperature: 40 degC, temperature_rise: 10 K}}}
      Diode: {hazard: {model: mil_hdbk_217f.diode_low_frequency, inputs: {kind: switching, contact: bonded,
        temperature: 50 degC, power: 0.5 W, thermal_resistance: 20 K/W, voltage: 5 V, rated_voltage: 50 V}}}
      Transistor: {hazard: {model: mil_hdbk_217f.transistor_fet_low_frequency, inputs: {kind: MOSFET,
        application: switching, rated_power: 0.5 W, temperature: 45 degC, power: 0 W}}}
      Amplifier: {hazard: {model: mil_hdbk_217f.microcircuit.linear, inputs: {transistors: 80, package: SMT-plastic,
        pins: 8, power: 0.2 W, thermal_resistance: 30 K/W, case_temperature: 55 degC, years_in_production: 3 year}}}
      Logic: {hazard: {model: mil_hdbk_217f.microcircuit.logic, inputs: {family: CMOS, gates: 90, package: SMT-plastic,
        pins: 14, power: 0 W, years_in_production: 3 year}}}
      Crystal: {hazard: {model: mil_hdbk_217f.crystal, inputs: {frequency: 8 MHz}}}
"""


def by_hand(t):
    """Failures/10⁶ h of the mixed board with t °C around its parts, by the printed formulas; cases in GM are at 50."""
    pins_8, pins_14 = (3.6e-4 * n**1.08 * 4 for n in (8, 14))
    return {
        "Capacitor": 0.0020 * arrhenius(t, 0.35) * 0.1**0.09 * ((0.5 / 0.6) ** 3 + 1) * 10 * 20,
        "Resistor": 0.0037 * arrhenius(t + 20, 0.08) * 0.1**0.39 * 0.71 * math.exp(1.1 * 0.4) * 10 * 16,
        "Coil": 0.00003 * arrhenius(t + 11, 0.11) * 3 * 12,
        "Diode": 0.0010 * semiconductor(t + 10 + 10, 3091) * 0.054 * 8 * 9,
        "Transistor": 0.012 * semiconductor(t + 5, 1925) * 0.7 * 8 * 9,
        "Amplifier": (0.010 * 0.1 * arrhenius(t + 15 + 6, 0.65) + pins_8) * 10,
        "Logic": (0.010 * 0.1 * arrhenius(t + 10, 0.35) + pins_14) * 10,
        "Crystal": 0.013 * 8**0.23 * 2.1 * 10,
    }


def live(robot, **readings):
    """The rate of every part [1/10⁶ h] by what its sensors have read for an hour."""
    exposure, ledger = ExposureIntegrator(robot), Ledger.new(robot)
    ledger.started = 0
    said = {name.rpartition(".")[0].strip("/"): name for name in robot.signals}
    samples = [
        Sample(second * SECOND, said[name], value) for second in range(60) for name, value in sorted(readings.items())
    ]
    exposure.integrate(ledger, samples, 60 * SECOND)
    factors = ledger.effective.value / ledger.age.value
    return {mode.path.rpartition("/")[2]: mode.rate * f * 1e6 for mode, f in zip(robot.modes, factors, strict=True)}


def nominal(robot):
    return {mode.path.rpartition("/")[2]: mode.rate * 1e6 for mode in robot.modes}


def test_a_mixed_board_at_85_degrees_by_hand():
    robot = parse(HEAD + MIXED)
    assert nominal(robot) == pytest.approx(by_hand(40), rel=1e-9)
    assert live(robot, board=85.0) == pytest.approx(by_hand(85), rel=1e-9)


def test_a_sensor_that_reads_what_was_designed_for_changes_nothing():
    robot = parse(HEAD + MIXED)
    assert live(robot, board=40.0) == pytest.approx(nominal(robot), rel=1e-12)


def test_a_leg_moves_what_a_sensor_moves():
    """Bound or not: a leg at 85 °C is a robot at 85 °C."""
    bound = parse(HEAD + MIXED)
    free = parse(HEAD + "\n".join(line for line in MIXED.splitlines() if "signals" not in line) + "\n")
    for robot in (bound, free):
        for key in ("temperature", "Board/temperature"):
            plan = parse_plan(
                f"schema_version: 1\ntasks: [{{duration: 1 h, stresses: {{{key}: 85 degC}}}}]\n", robot, "task"
            )
            outlook = as_lived(Plant(robot), ExposureIntegrator(robot), Ledger.new(robot))
            factor = (steps := planned(outlook, plan.tasks[0])).effective[:, 0] / steps.advance[:, 0]
            got = {m.path.rpartition("/")[2]: m.rate * f * 1e6 for m, f in zip(robot.modes, factor, strict=True)}
            assert got == pytest.approx(by_hand(85), rel=1e-9)


def one_part(name, more=""):
    """A module with one part by a model, its inputs plausible, under a sensor of temperature."""
    model = handbook_model(name)
    inputs = json.loads((DATA / "plausible_inputs" / f"{name}.json").read_text())
    clock = {"h": "operating", "cycle": "cycles"}[model.unit.removeprefix("1/")]
    part = {"clock": clock, "hazard": {"model": name, "inputs": inputs}}
    if "b10" in inputs:
        part["life"] = {"distribution": "weibull", "shape": inputs.get("shape", 1)}
    module = {
        "ambient": "30 degC",
        "signals": {"temperature": {"topic": "/t", "field": "x"}},
        "components": {"Part": part},
    }
    text = {"schema_version": 1, "name": "One", "usage": {"cycles": "1 cycle/h"}, "modules": {"M": module}}
    return parse(json.dumps(text)).modes[0].stresses[0]


@pytest.mark.parametrize("name", handbook_models())
def test_every_temperature_in_operation_is_reached(name):
    """Of all models: no temperature is left to a name that happens to fit, and each says whose temperature it is."""
    model = handbook_model(name)
    warm = {key for key, entry in model.numbers.items() if entry.unit == "degC"} - NEVER_OPERATED_AT
    assert {key for key, entry in model.numbers.items() if entry.driver == "temperature"} == warm
    assert {key for key, entry in model.numbers.items() if entry.unit == "K"} <= SWINGS_AND_RISES
    if not warm:
        return
    stress = one_part(name)
    assert set(stress.channels) == warm
    for key, channel in stress.channels.items():
        own = model.numbers[key].warmth == "own"
        rise = stress.design[key] - 30 if own else 0
        assert channel.scale * 60 + channel.offset == pytest.approx(60 + rise)
        assert [(one.name, one.around) for one in stress.drivers[key]][-1] == ("temperature", True)
    cold, hot = (
        float(stress.factor({key: np.array([c.scale * t + c.offset]) for key, c in stress.channels.items()}).value[0])
        for t in (40, 60)
    )
    assert hot > cold or (hot == cold and name in IN_STEPS)


def test_the_accelerations_too():
    for model in ACCELERATIONS.values():
        warm = {key for key, entry in model.numbers.items() if entry.unit == "degC"} - NEVER_OPERATED_AT
        assert warm <= {"temperature"}
        assert {key for key, entry in model.numbers.items() if entry.unit == "K"} <= SWINGS_AND_RISES


CHIP = """
modules:
  Board:
    %s
    components:
      Chip:
        %s
        hazard: {model: mil_hdbk_217f.microcircuit.linear, inputs: {transistors: 80, package: SMT-plastic,
          pins: 8, power: 0 W, case_temperature: 55 degC, years_in_production: 3 year}}
      %s
"""
TEMPERATURE = "temperature: {topic: /board, field: temperature, range: [-40, 150]}"
CAPACITOR = """%s: {hazard: {model: mil_hdbk_217f.capacitor, inputs: {style: CDR, capacitance: 0.1 uF, dc_voltage: 5 V,
        rated_voltage: 10 V, temperature: %s degC}}}"""


def case(board="", chip="", more="", readings=None):
    """The case temperature that the chip's rate at 85 °C around it stands for, less 85, and what `check` says."""
    robot = parse(HEAD + CHIP % (board, chip, more))
    rate = live(robot, **(readings or {"board": 85.0}))["Chip"]
    energy = (rate / 10 - 3.6e-4 * 8**1.08 * 4) / (0.010 * 0.1)
    return 1 / (1 / 298 - math.log(energy) * 8.617e-5 / 0.65) - 273 - 85, robot


@pytest.mark.parametrize(
    ("board", "chip", "more", "rise"),
    [
        (f"ambient: 35 degC\n    signals: {{{TEMPERATURE}}}", "", "", 20),
        (f"signals: {{{TEMPERATURE}}}", "", CAPACITOR % ("C", 45), 10),  # what a part beside it says is around it
        (f"ambient: 35 degC\n    signals: {{{TEMPERATURE}}}", "", CAPACITOR % ("C", 45), 20),  # what is stated wins
        (f"signals: {{{TEMPERATURE}}}", "offsets: {temperature: 7 K}", CAPACITOR % ("C", 45), 7),
        (f"signals: {{{TEMPERATURE}}}", "", "", 0),  # nothing says how warm it is around it
        (f"signals: {{{TEMPERATURE}}}", "", CAPACITOR % ("C", 45) + "\n      " + CAPACITOR % ("D", 50), 0),
        ("ambient: 35 degC", f"signals: {{{TEMPERATURE}}}", "", 0),  # a sensor of its own
        ("ambient: 35 degC", f"signals: {{{TEMPERATURE.replace('temperature:', 'case_temperature:')}}}", "", 0),
        (f"ambient: 35 degC\n    signals: {{{TEMPERATURE}, case_temperature: {{topic: /case, field: temperature}}}}",
         "", "", -5),
    ],
)  # fmt: skip
def test_the_rise_is_what_the_design_says(board, chip, more, rise):
    readings = {"case": 80.0} if "/case" in board else {"board": 85.0}  # nothing else listens to the board
    assert case(board, chip, more, readings)[0] == pytest.approx(rise, abs=1e-6)


def test_check_says_what_is_assumed(tmp_path):
    sensor = f"signals: {{{TEMPERATURE}}}"
    stated = case(f"ambient: 35 degC\n    {sensor}")[1]
    assert (stated.warnings, stated.notes) == ((), ())
    assert case(sensor)[1].warnings == (
        "modules/Board/signals/temperature: is taken for the own temperature of Board/Chip: nothing says how warm it "
        "is around them as designed; expected e.g. ambient: 40 degC, above which each keeps its rise",
    )
    alike = case(sensor, more=CAPACITOR % ("C", 45))[1]
    assert alike.warnings == ()
    assert alike.notes == (
        "modules/Board/signals/temperature: Board/Chip keeps its rise above 45 degC, the ambient temperature as other "
        "parts there state it; expected ambient, to say so",
    )


def test_check_names_what_no_sensor_drives(tmp_path):
    more = """Crystal: {hazard: {model: mil_hdbk_217f.crystal, inputs: {frequency: 8 MHz}}}
      Fan: {rate: 100 FIT}
      Chosen: {rate: 100 FIT, acceleration: none}"""
    path = tmp_path / "board.yaml"
    path.write_text(HEAD + CHIP % (f"ambient: 35 degC\n    signals: {{{TEMPERATURE}}}", "", more))
    assert case(f"ambient: 35 degC\n    signals: {{{TEMPERATURE}}}", "", more)[1].warnings == ()
    said = CliRunner().invoke(app, ["check", str(path)])
    assert said.exit_code == 0
    assert (
        "note: modules/Board/signals/temperature: covers parts that no sensor drives: Board/Crystal "
        "(mil_hdbk_217f.crystal takes no temperature); Board/Fan (a constant rate: an acceleration would make it "
        "answer)"
    ) in said.output
    assert "Chosen" not in said.output
    document = json.loads(CliRunner().invoke(app, ["check", str(path), "--json"]).stdout)
    assert "Board/Fan" in document["notes"][0]


def test_a_voltage_is_that_of_the_part_alone():
    """All parts of a place have its temperature; each has its own voltage, whatever its model calls it."""
    own = "signals: {voltage: {topic: /v, field: voltage}}, hazard"
    beside = f"signals: {{{TEMPERATURE}, voltage: {{topic: /supply, field: voltage}}}}"
    robot = parse(
        HEAD
        + CHIP % (beside, "", CAPACITOR % ("C", 40) + "\n      " + (CAPACITOR % ("D", 40)).replace("hazard", own, 1))
    )
    channels = {mode.path: dict(mode.stresses[0].channels) for mode in robot.modes}
    assert "dc_voltage" not in channels["Board/C"]
    assert channels["Board/D"]["dc_voltage"].signal == "/v.voltage"
    assert parse_plan("schema_version: 1\ntasks: [{duration: 1 h, stresses: {Board/C/voltage: 6 V}}]\n", robot)
    with pytest.raises(DesignError, match="no part takes a stress 'voltage'"):
        parse_plan("schema_version: 1\ntasks: [{duration: 1 h, stresses: {voltage: 6 V}}]\n", robot)


def test_a_model_that_answers_to_temperature_by_another_name_is_not_accelerated_twice():
    with pytest.raises(DesignError, match="double acceleration"):
        case(chip="acceleration: {model: q10}")


@pytest.mark.parametrize("name", ["kicad_board.csv", "altium_board.csv"])
def test_an_imported_board_at_85_degrees_is_one_imported_at_85_degrees(tmp_path, name):
    """The list says nothing of temperatures: what it is assumed to be, or is measured to be, is the same."""
    source = DATA / "bom" / name
    text, hot = (
        import_bom(source, tmp_path / "none.yaml", assumptions=Assumptions(temperature=at), module=["Board"])
        for at in ("40 degC", "85 degC")
    )
    design = tmp_path / "board.yaml"
    design.write_text(text.text.replace("  Board:\n", f"  Board:\n    signals: {{{TEMPERATURE}}}\n", 1))
    robot = load(design)
    assert sum(nominal(robot).values()) < 0.7 * sum(nominal(hot.robot).values())
    assert live(robot, board=85.0) == pytest.approx(nominal(hot.robot), rel=1e-9)
