"""The words and the JSON of ``robophm availability``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from robophm.cli.app import app

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


def test_what_is_said(design: Path) -> None:
    said = CliRunner().invoke(app, ["availability", str(design), "--within", "30 day"])
    assert said.exit_code == 0
    for words in ("within 30 days", "4 × drive", "1 part is not repaired: lidar", "stays failed"):
        assert words in said.output


def test_json_has_all_digits(design: Path) -> None:
    said = CliRunner().invoke(app, ["availability", str(design), "--within", "1000", "--json"])
    (found,) = json.loads(said.output)["availability"].values()
    assert found["hours"] == 1000
    assert [part["unit"] for part in found["parts"]] == ["drive", "lidar"]
    assert found["parts"][0]["failures"] == pytest.approx(4 * 0.996, rel=1e-3)  # λ t (1 − λ r)


@pytest.mark.parametrize(
    ("options", "said"),
    [(["--within", "-1"], "--within"), (["--failed", "driv"], "drive"), (["--function", "go"], "go")],
)
def test_mistakes_are_named(design: Path, options: list[str], said: str) -> None:
    found = CliRunner().invoke(app, ["availability", str(design), *options])
    assert found.exit_code not in (0, 1)
    assert said in found.output + str(found.exception or "")
