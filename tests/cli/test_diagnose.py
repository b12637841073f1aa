"""robophm fmeca and robophm diagnose, run as a newcomer does."""

import csv
import io
import json

import pytest

ROBOT = """
schema_version: 1
name: courier
components:
  battery: {rate: 50 FPMH}
  computer: {rate: 10 FPMH, monitored: true}
  motor: {quantity: 2, failure_modes: {winding: {rate: 8 FPMH}, bearing: {rate: 20 FPMH}}}
  lidar: {rate: 30 FPMH}
  camera: {rate: 90 FPMH}
diagram: {series: [battery, computer, motor, {parallel: [lidar, camera]}]}
functions: {drive: {series: [battery, motor]}}
"""
SENSORS = """sensor,part,detects,false alarm,price,fitted
vibration,motor/bearing,0.9,0.01,,
vibration,motor/winding,0.2,,,
self test,lidar,0.95,0.001,50,no
image check,camera,0.8,0.01,20,no
"""


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    (tmp_path / "sensors.csv").write_text(SENSORS)
    return path


def test_fmeca_as_table_csv_and_page(inside, robot, tmp_path):
    text = inside("fmeca", robot, "--sensors", "sensors.csv", "--to", "fmeca.csv")
    assert text.returncode == 0
    assert "redundancy is lost" in text.stdout
    rows = list(csv.DictReader(io.StringIO((tmp_path / "fmeca.csv").read_text())))
    assert len(rows) == 6
    bearing = next(row for row in rows if row["failure mode"] == "motor/bearing")
    assert bearing["detected by"] == "vibration 90 %"
    assert int(bearing["RPN"]) == int(bearing["severity"]) * int(bearing["occurrence"]) * int(bearing["detection"])
    assert inside("fmeca", robot, "--to", "fmeca.html", "--severity", "drive=9").returncode == 0
    assert "<h2>Failure modes</h2>" in (tmp_path / "fmeca.html").read_text()
    said = json.loads(inside("fmeca", robot, "--json").stdout)
    assert {one["mode"] for one in said["modes"]} >= {"battery", "motor/winding"}


def test_diagnosis(inside, robot):
    words = ("diagnose", robot, "sensors.csv", "--alarm", "vibration", "--add", 1, "--at", 3000)
    text = inside(*words).stdout
    assert "Nothing fitted sees: battery, lidar, camera" in text
    said = json.loads(inside(*words, "--json").stdout)
    assert said["suspects"][0]["fault"] == "motor/bearing"
    assert said["sensors"]["exhaustive"]
    assert said["sensors"]["chosen"] == ["image check"] or said["sensors"]["chosen"] == ["self test"]
    assert (
        0 < said["sensors"]["gains"][0] <= said["sensors"]["all_candidates"] <= said["sensors"]["variance"] * (1 + 1e-9)
    )
    quiet = json.loads(inside("diagnose", robot, "sensors.csv", "--quiet", "--json").stdout)
    assert quiet["no_fault"] > 0.95


def test_mistakes_are_one_line(inside, robot, tmp_path):
    for text, said in (
        ("sensor,part\ns,motr\n", "no part 'motr' in the design; did you mean 'motor'"),
        ("sensor,part,detects\ns,motor,1.5\n", "detects: 1.5; expected a probability"),
        ("sensor,part,detects\ns,motor,8.0 N m\n", "detects: '8.0 N m' is no number; expected one without a unit"),
        ("sensor,part,detects\ns,motor,inf\n", "detects: 'inf' is not a finite number"),
        ("sensor,part\ns,motor\ns,motor/bearing\n", "that 's' sees 'motor/bearing' stands twice"),
        ("sensor,part,fitted\ns,motor,yes\ns,lidar,no\n", "'s' was said to be otherwise above"),
        ("sensor,part,price\ns,motor,-1\n", "price: -1; expected above 0"),
    ):
        (tmp_path / "bad.csv").write_text(text)
        failed = inside("diagnose", robot, "bad.csv")
        assert failed.returncode == 3
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1
    for words, said in (
        (
            ("diagnose", robot, "sensors.csv", "--alarm", "vibraton"),
            "no fitted sensor 'vibraton'; did you mean 'vibration'",
        ),
        (("diagnose", robot, "sensors.csv", "--add", 1), "nothing can have failed unseen"),
        (("fmeca", robot, "--severity", "drive=11"), "expected e.g. drive=9, from 1 to 10"),
        (("fmeca", robot, "--severity", "drve=9"), "did you mean 'drive'"),
        (("fmeca", robot, "--to", "x.pdf"), "a name that ends in .csv or .html"),
    ):
        failed = inside(*words)
        assert failed.returncode == 3
        assert said in failed.stderr
