"""`robophm import-bom`: a dry run writes nothing, a fault changes nothing, and everything is said."""

import json
from pathlib import Path

import pytest

from robophm.cli import INVALID, OK, USAGE
from robophm.design.file import load

DATA = Path(__file__).parents[1] / "data" / "bom"


def test_a_design_and_what_is_said(inside, tmp_path):
    done = inside("import-bom", DATA / "messy.csv", "robot.yaml")
    assert done.returncode == OK
    assert load(tmp_path / "robot.yaml").name == "robot"
    assert "warning: messy.csv: row 15, Quantity (per board): 'ten'; expected a whole number" in done.stderr
    assert "needs a rate (3)" in done.stdout
    assert "C6 is not fitted" in done.stdout
    assert "nothing written" not in done.stdout
    assert inside("check", "robot.yaml").returncode == OK


def test_a_dry_run_as_json(inside, tmp_path):
    done = inside("import-bom", DATA / "kicad.csv", "robot.yaml", "--dry-run", "--json")
    assert (done.returncode, done.stderr, list(tmp_path.iterdir())) == (OK, "", [])
    said = json.loads(done.stdout)
    assert (said["schema_version"], said["written"], said["header_row"]) == (1, False, 1)
    assert {column["field"]: column["confidence"] for column in said["columns"]}["reference"] > 0.9
    rated = [part for part in said["parts"] if part["model"]]
    assert said["hazard_rate"] == pytest.approx(
        sum(part["quantity"] * part["hazard_rate"] for part in rated), rel=1e-12
    )
    assert {note["row"]: note["text"] for note in said["left_out"]}[5] == "C8,C9 is not fitted (DNP)"
    styles = [one for one in said["assumed"] if (one["kind"], one["input"]) == ("capacitor", "style")]
    assert styles == [{"kind": "capacitor", "input": "style", "rows": 3, "values": {"CDR": 1, "CE": 1, "CWR": 1}}]
    for part in rated:
        assert part["assumed"].keys() <= {"model", *part["inputs"]}
    assert said["assumptions"]["environment"] == "GM"


def test_what_was_there_is_kept_beside_it(inside, tmp_path):
    there = tmp_path / "robot.yaml"
    text = "schema_version: 1\nname: mine\ncomponents:\n  lidar: {rate: 300 FIT}  # bought\n"
    there.write_text(text)
    done = inside("import-bom", DATA / "altium.csv", there, "--module", "Power/Motor board", "--environment", "GF")
    assert done.returncode == OK
    assert (tmp_path / "robot.yaml.bak").read_text() == text
    assert there.read_text().startswith(text)
    assert "Power/Motor board/C1-C3" in {part.path for part in load(there).all_components()}


def test_a_mapping_is_saved_and_used(inside, tmp_path):
    source = tmp_path / "list.csv"
    source.write_text("Reference;Wo;Wert\nC1;0,2u Kerko;0,1u Kerko\n")
    assert inside("import-bom", source, "robot.yaml", "--save-mapping", "map.yaml").returncode == OK
    text = (tmp_path / "map.yaml").read_text()
    assert "  value: Wert\n" in text
    (tmp_path / "map.yaml").write_text(text.replace("Wert", "Wo"))
    done = inside("import-bom", source, "robot.yaml", "--mapping", "map.yaml", "--dry-run", "--json")
    columns = {column["field"]: column["header"] for column in json.loads(done.stdout)["columns"]}
    assert columns["value"] == "Wo"


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["list.csv", "list.csv"], "is read or kept by this command too"),
        (["list.csv", "robot.yaml", "--module", "a//b"], "expected names with / between them"),
        (["list.csv", "robot.yaml", "--temperature", "warm"], "is not a number with a unit"),
        (["none.csv", "robot.yaml"], "no such file"),
        (["bad.csv", "robot.yaml"], "is not text"),
        (["ics.csv", "robot.yaml"], "no part of ics.csv has a rate"),
        (["list.csv", "robot.yaml", "--save-mapping", "robot.yaml"], "is read or kept by this command too"),
    ],
)
def test_a_fault_is_one_line_and_changes_nothing(inside, tmp_path, words, error):
    (tmp_path / "list.csv").write_text("Reference,Value\nC1,100n ceramic\n")
    (tmp_path / "ics.csv").write_text("Reference,Value\nZZ1,thing\n")
    (tmp_path / "bad.csv").write_bytes(b"\x00\x01")
    there = tmp_path / "robot.yaml"
    there.write_text("mine")
    if "no part" in error:
        there.unlink()
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    done = inside("import-bom", *words)
    assert (done.returncode, done.stdout, len(done.stderr.splitlines())) == (INVALID, "", 1)
    assert error in done.stderr
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_stress_beyond_the_rated_is_a_usage_error(inside):
    assert inside("import-bom", DATA / "kicad.csv", "robot.yaml", "--stress", "2").returncode == USAGE
