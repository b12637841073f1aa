"""The words and the JSON of ``robophm availability``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

DESIGN = """schema_version: 1
name: amr
repair: 4 h
components:
  drive: {rate: 1e-3 /h, quantity: 4}
  lidar: {mtbf: 20000 h, repair: none}
"""


@pytest.fixture
def design(tmp_path: Path) -> Path:
    file = tmp_path / "amr.yaml"
    file.write_text(DESIGN)
    return file


def test_what_is_said(inside, design: Path) -> None:
    said = inside("availability", design, "--within", "30 day")
    assert said.returncode == 0
    for words in ("within 30 days", "4 × drive", "1 part is not repaired: lidar", "stays failed"):
        assert words in said.stdout


def test_json_has_all_digits(inside, design: Path) -> None:
    said = inside("availability", design, "--within", "1000", "--json")
    (found,) = json.loads(said.stdout)["availability"].values()
    assert found["hours"] == 1000
    assert [part["unit"] for part in found["parts"]] == ["drive", "lidar"]
    assert found["parts"][0]["failures"] == pytest.approx(4 * 0.996, rel=1e-3)  # λ t (1 − λ r)


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--within", "-1"], "--within"), (["--failed", "driv"], "drive"), (["--function", "go"], "go")],
)
def test_mistakes_are_named(inside, design: Path, options: list[str], said: str) -> None:
    found = inside("availability", design, *options)
    assert found.returncode == 3
    assert said in found.stderr
    assert found.stderr.count("\n") == 1
