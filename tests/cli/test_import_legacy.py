"""`robophm import-legacy`: writes a design whole or not at all, and says what is odd on stderr."""

import json
from pathlib import Path

import pytest

from robophm.cli import INVALID, OK
from robophm.design.file import load

DATA = Path(__file__).parents[1] / "data"


def test_a_design_and_a_table(inside, tmp_path):
    done = inside("import-legacy", DATA / "legacy_ota.yaml", "robot.yaml")
    assert done.returncode == OK
    warnings = done.stderr.splitlines()
    assert len(warnings) == 2
    assert warnings[0].startswith(
        "warning: legacy_ota.yaml: line 42: Communication/DSK-M: s1 names '25MHz Cryst. Osc.'"
    )
    rows = {line.split()[0]: line.split() for line in done.stdout.splitlines()}
    assert rows["legacy_ota"][1:7:2] == ["5.288e-4", "5.288e-4", "5.285e-4"]
    assert rows["Communication"][1:7:2] == ["1.062e-5", "1.062e-5", "1.035e-5"]
    assert rows["Sensing"][1:7:2] == ["8.238e-6", "8.238e-6", "8.181e-6"]
    assert load(tmp_path / "robot.yaml").name == "legacy_ota"
    assert inside("check", "robot.yaml").returncode == OK


def test_json(inside):
    done = inside("import-legacy", DATA / "legacy_ota.yaml", "robot.yaml", "--json")
    assert (done.returncode, done.stderr) == (OK, "")
    said = json.loads(done.stdout)
    assert said["design"] == "robot.yaml"
    assert [finding["kind"] for finding in said["findings"]] == ["double use", "renamed"]
    assert said["hours"] == 1000
    assert {"", "Mobility", "Communication"} <= {module["path"] for module in said["modules"]}
    assert said["modules"][0]["legacy_reliability"] == pytest.approx(0.589292457145637, rel=1e-14, abs=0)


def test_what_is_there_stays_unless_forced(inside, tmp_path):
    there = tmp_path / "robot.yaml"
    there.write_text("mine")
    done = inside("import-legacy", DATA / "legacy_ota.yaml", there)
    assert (done.returncode, there.read_text()) == (INVALID, "mine")
    assert "exists already; --force" in done.stderr
    assert inside("import-legacy", DATA / "legacy_ota.yaml", there, "--force").returncode == OK
    assert there.read_text().startswith("# Made of legacy_ota.yaml")


@pytest.mark.parametrize("text", ["System: {A: {Failure Rate: abc}}", "a: [", "System: {}", "\x00", "System: {A: *a}"])
def test_a_bad_file_writes_nothing(inside, tmp_path, text):
    source, there = tmp_path / "old.yaml", tmp_path / "robot.yaml"
    source.write_text(text)
    done = inside("import-legacy", source, there)
    assert done.returncode == INVALID
    assert done.stderr.startswith(f"error: {source}")
    assert (len(done.stderr.splitlines()), done.stdout) == (1, "")
    assert not there.exists()
    there.write_text("mine")
    assert inside("import-legacy", source, there, "--force").returncode == INVALID
    assert there.read_text() == "mine"


def test_the_source_is_never_overwritten(inside, tmp_path):
    source = tmp_path / "old.yaml"
    source.write_bytes((DATA / "legacy_ota.yaml").read_bytes())
    done = inside("import-legacy", source, source, "--force")
    assert done.returncode == INVALID
    assert source.read_bytes() == (DATA / "legacy_ota.yaml").read_bytes()
    assert "no such folder" in inside("import-legacy", source, tmp_path / "no" / "robot.yaml").stderr
    assert "no such file; did you mean 'old.yaml'" in inside("import-legacy", "olt.yaml", "robot.yaml").stderr
