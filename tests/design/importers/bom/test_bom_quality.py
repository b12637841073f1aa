"""The quality of an imported board: not known until somebody says it, in one line."""

import json

import pytest

from robophm.cli.import_bom import command
from robophm.design.importers.bom import import_bom, rate_range, total_rate
from robophm.design.importers.bom.assumptions import Assumptions

LIST = "Reference,Value,Description\nR1-R4,10k,resistor 0603\nC1,100nF,ceramic capacitor 50V\nU1,LM358,op amp SOIC-8\n"
RATED = "schema_version: 1\nname: r\nenvironment: GM\ncomponents:\n  F1: {hazard: {model: mil_hdbk_217f.fuse}}\n"


@pytest.fixture
def listed(tmp_path):
    path = tmp_path / "board.csv"
    path.write_text(LIST, encoding="utf-8")
    return path


def of_quality(listed, said):
    design = listed.with_name(f"{said}.yaml")
    return import_bom(listed, design, assumptions=Assumptions(quality=said), module=["Board"])


def test_nobody_has_said_it_and_the_rate_is_a_range_between_the_two(listed):
    found = of_quality(listed, None)
    assert found.text.count("quality: unknown  # commercial, known pedigree or military, once somebody knows\n") == 1
    low, high = rate_range(found.parts)
    assert low == pytest.approx(total_rate(of_quality(listed, "known pedigree").parts), rel=1e-12)
    assert high == pytest.approx(total_rate(of_quality(listed, "commercial").parts), rel=1e-12)
    assert low < total_rate(found.parts) < high
    by_design = sum(part.quantity * part.modes[0].rate for part in found.robot.all_components())
    assert by_design == pytest.approx(total_rate(found.parts), rel=1e-12)


def test_one_line_narrows_it(listed):
    design = listed.with_name("robot.yaml")
    design.write_text(of_quality(listed, None).text, encoding="utf-8")
    said = import_bom(listed, design, assumptions=Assumptions(quality="known pedigree"), module=["Board"])
    assert [one.outcome.state for one in said.parts] == ["unchanged"] * 3
    begun = of_quality(listed, "known pedigree").text.replace("name: known pedigree", "name: None")
    assert said.text == begun
    low, high = rate_range(said.parts)
    assert low == high == pytest.approx(total_rate(said.parts), rel=1e-12)


@pytest.mark.parametrize("text", [RATED, RATED.replace("environment", "quality: military\nenvironment")])
def test_what_is_rated_there_already_is_not_made_uncertain(listed, text):
    design = listed.with_name("robot.yaml")
    design.write_text(text, encoding="utf-8")
    found = import_bom(listed, design)
    assert "unknown" not in found.text
    low, high = rate_range(found.parts)
    assert low == high


def test_the_command_says_the_range_first(listed, capsys):
    design = listed.with_name("robot.yaml")
    command(listed, design, dry_run=True)
    shown = " ".join(capsys.readouterr().out.split())
    assert "nobody has said its quality: λ is " in shown
    assert "(known pedigree, 5 %) … " in shown
    command(listed, design, dry_run=True, as_json=True)
    said = json.loads(capsys.readouterr().out)
    assert said["hazard_rate_by_quality"]["low"] < said["hazard_rate"] < said["hazard_rate_by_quality"]["high"]
