"""An imported board whose temperature is measured heats up: all its parts are driven, and what is not is counted."""

import json

import pytest

from robophm.core.units import quantity
from robophm.design.file import parse
from robophm.design.importers.bom import import_bom
from robophm.design.importers.bom.assumptions import Assumptions

BOARD = """
schema_version: 1
name: robot
environment: vehicle
modules:
  Board:
    ambient: 40 degC
    signals:
      temperature: {topic: /board, field: temperature, range: [-40, 125]}
    components:
      Fan: {mtbf: 50000 h}
"""
TAKES_NO_TEMPERATURE = {
    "": "an entry of the library",
    "mil_hdbk_217f.crystal": "§19.1 has none",
    "mil_hdbk_217f.filter": "§21.1 has none",
    "mil_hdbk_217f.fuse": "§22.1 has none",
}


def imported(shared, tmp_path, name, temperature="40 degC"):
    design = tmp_path / "robot.yaml"
    design.write_text(BOARD, encoding="utf-8")
    assumed = Assumptions(temperature=temperature, quality="commercial")
    return import_bom(shared / "boms" / name, design, assumptions=assumed, module=["Board"])


@pytest.mark.parametrize("name", ["odrive34_24.csv", "pixhawk_fmuv3.xlsx", "vesc412.ods"])
def test_the_temperature_of_a_board_drives_all_parts_whose_model_takes_one(shared, tmp_path, name):
    """At 85 °C each part has the rate that its handbook gives where all around it is assumed at 85 °C."""
    found = imported(shared, tmp_path, name)
    hot = imported(shared, tmp_path, name, "85 degC")
    rates = {one.outcome.name: one.hazard_rate for one in hot.parts}
    left = {part.name for part in found.robot.all_components() if not part.sensed} - {"Fan"}
    by_name = {one.outcome.name: one for one in found.parts}
    assert {by_name[name].rating.model for name in left} <= TAKES_NO_TEMPERATURE.keys()
    assert len(left) < 0.1 * len(found.parts)
    for part in found.robot.all_components():
        for stress in (stress for mode in part.modes for stress in mode.measured):
            at = {name: 85 + bound.shift for name, bound in stress.channels.items()}
            assert stress.model.evaluate({**stress.design, **at}).value == pytest.approx(rates[part.name], rel=1e-9)
    total = sum(one.part.quantity * one.hazard_rate for one in found.parts if one.hazard_rate)
    heated = sum(one.part.quantity * one.hazard_rate for one in hot.parts if one.hazard_rate)
    assert 2 < heated / total < 10  # of capacitors alone: 0.35 eV over 45 K is 5


def test_what_no_sensor_drives_is_counted(shared, tmp_path, monkeypatch, capsys):
    from robophm.cli.check import command

    found = imported(shared, tmp_path, "odrive34_24.csv")
    design = tmp_path / "board.yaml"
    design.write_text(found.text, encoding="utf-8")
    command(design)
    assert "181 parts, 2 that no sensor drives, 1 signal, 0 warnings" in capsys.readouterr().out.replace("\n", " ")
    command(design, as_json=True)
    assert json.loads(capsys.readouterr().out)["parts_no_sensor_drives"] == 2  # the fan and the crystal


def test_a_junction_keeps_its_rise_above_the_board():
    text = BOARD.replace("Fan: {mtbf: 50000 h}", (
        "U1: {hazard: {model: mil_hdbk_217f.microcircuit.linear, inputs: {package: SMT-plastic, pins: 8, power: 0 W, "
        "transistors: 100, case_temperature: 50 degC, years_in_production: 2 year}}}"
    ))  # fmt: skip
    (part,) = parse(text).all_components()
    (bound,) = part.modes[0].stresses[0].channels.values()
    assert bound.shift == pytest.approx(quantity("10 K", "K"))


def test_the_quality_of_a_board_is_said_once_and_its_parts_follow(shared, tmp_path):
    design = tmp_path / "robot.yaml"
    design.write_text(BOARD, encoding="utf-8")
    said = import_bom(
        shared / "boms" / "vesc412.ods", design, assumptions=Assumptions(quality="known pedigree"), module=["Board"]
    )
    assert said.text.count("quality: known pedigree") == 1
    assert not any(one.rating and "quality" in one.rating.inputs for one in said.parts)
    rates = {one.outcome.name: one.hazard_rate for one in said.parts}
    for part in said.robot.all_components():
        if part.name != "Fan":
            assert sum(mode.rate for mode in part.modes) == pytest.approx(rates[part.name], rel=1e-12)
    plain = imported(shared, tmp_path, "vesc412.ods")
    total = [sum(one.part.quantity * (one.hazard_rate or 0) for one in found.parts) for found in (said, plain)]
    assert total[0] < 0.3 * total[1]
