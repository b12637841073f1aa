"""The designs and entries that the guide shows are valid, and its figures those of a run."""

import re
from pathlib import Path

import pytest

from robophm.design.file import parse
from robophm.parts import part
from robophm.parts.entries import read_entries

TEXT = (Path(__file__).parents[2] / "docs" / "guides" / "parts.md").read_text(encoding="utf-8")
DESIGN, ENTRY = re.findall(r"```yaml\n(.*?)```", TEXT, re.S)


def test_its_design_is_one():
    robot = parse(f"schema_version: 1\nname: R\n{DESIGN}")
    lidar, elbow, fans = robot.all_components()
    assert lidar.modes[0].source == part("lidar_2d").origin
    assert elbow.modes[0].life.survival(10_000.0) == pytest.approx(0.9)
    assert (elbow.modes[0].source, len(elbow.modes[0].measured)) == ("", 1)
    assert (fans.quantity, fans.required) == (3, 2)
    assert robot.warnings == ()


def test_its_entry_is_one():
    (entry,) = read_entries(ENTRY, "guide", "bearings")
    assert entry.grade == "C"


def test_how_much_longer_than_its_tenth_a_mean_life_is():
    for said, life in (("9.5", "exponential"), ("2.7", "weibull, shape: 2")):
        assert f"{said} times" in TEXT
        text = f"components: {{A: {{l10: 1 h, life: {{distribution: {life}}}}}}}"
        (mode,) = parse(f"schema_version: 1\nname: R\n{text}").modes
        assert mode.life.mean() == pytest.approx(float(said), abs=0.05)
