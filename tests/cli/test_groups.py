"""The command line on robots with groups of dependent parts, as a newcomer meets it."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

DESIGN = """
schema_version: 1
name: rover
components:
  A: {rate: 0.01 /h}
  B: {rate: 0.01 /h}
diagram: {standby: {of: [A, B]}}
task: {duration: 50 h}
"""
WARM = """
schema_version: 1
name: rover
components:
  pump: {rate: 1e-3 /h, life: {distribution: weibull, shape: 2}, quantity: 4}
diagram: {standby: {of: [pump], active: 2, dormancy: 0.1}}
"""


def test_a_standby_pair_is_drawn_and_promised(inside: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    shown = inside("show", "robot.yaml", "--at", "50")
    assert shown.returncode == 0
    assert "(1/2 standby)" in shown.stdout
    assert "90.98 %" in shown.stdout  # exp(−0.5)·1.5
    drawn = inside("show", "robot.yaml", "--svg", "robot.svg")
    assert drawn.returncode == 0
    assert (tmp_path / "robot.svg").read_text().count('class="ok spare"') == 1
    told = json.loads(inside("task", "robot.yaml", "--json").stdout)
    assert f"{math.exp(-0.5) * 1.5:.15f}"[:13] in json.dumps(told)
    assert inside("predict", "robot.yaml").returncode == 0


def test_what_is_not_exact_is_refused_and_estimated(inside: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(WARM)
    refused = inside("show", "robot.yaml")
    assert refused.returncode != 0
    assert refused.stderr.count("\n") == 1
    assert "--monte-carlo" in refused.stderr
    found = json.loads(inside("show", "robot.yaml", "--monte-carlo", "20000", "--json").stdout)
    assert found["low"] < found["probability"] < found["high"]
    assert found == json.loads(inside("show", "robot.yaml", "--monte-carlo", "20000", "--json").stdout)


def test_the_2020_tool_knows_no_groups(inside: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    refused = inside("show", "robot.yaml", "--legacy")
    assert refused.returncode != 0
    assert "standby of A, B" in refused.stderr


def test_chance_knows_what_fails_together(inside: Callable[..., Any], tmp_path: Path) -> None:
    """Of a pair, a tenth of whose failures takes both: R = exp(−βλt)·(1 − (1 − exp(−(1 − β)λt))²)."""
    text = "schema_version: 1\nname: R\ncomponents: {A: {rate: 1e-3 /h}, B: {rate: 1e-3 /h}}\n"
    text += "common_causes: {flood: {of: [A, B], beta: 0.1}}\ndiagram: {parallel: [A, B]}\n"
    (tmp_path / "pair.yaml").write_text(text)
    found = json.loads(inside("show", "pair.yaml", "--at", "100", "--monte-carlo", "100000", "--json").stdout)
    expected = math.exp(-0.01) * (1 - (1 - math.exp(-0.09)) ** 2)
    error = math.sqrt(expected * (1 - expected) / 100_000)
    assert found["probability"] == pytest.approx(expected, abs=5 * error)


REFUSED = {
    "a shared load": "{load_sharing: {of: [A, B, C], exponent: 2}}",
    "two of three warm": "{standby: {of: [A, B, C], active: 2, dormancy: 0.1}}",
    "cold, its spares not equal": "{standby: {of: [A, B, C, D], active: 2}}",
    "in a function": "A\nfunctions: {lift: {load_sharing: {of: [B, C, D], exponent: 2}}}",
}


@pytest.mark.parametrize("diagram", REFUSED.values(), ids=REFUSED.keys())
def test_what_a_command_refuses_check_refuses(inside: Callable[..., Any], tmp_path: Path, diagram: str) -> None:
    """In the same words, and with the same exit code."""
    parts = ", ".join(f"{name}: {{rate: 1e-3 /h, life: {{distribution: weibull, shape: {shape}}}}}"
                      for name, shape in zip("ABCD", (2, 2, 2, 3), strict=True))  # fmt: skip
    text = f"schema_version: 1\nname: R\ncomponents: {{{parts}}}\ntask: {{duration: 1 h}}\ndiagram: {diagram}\n"
    (tmp_path / "robot.yaml").write_text(text)
    checked = inside("check", "robot.yaml")
    assert checked.returncode == 3
    assert checked.stdout == ""
    says = checked.stderr.splitlines()[-1].removeprefix("error: robot.yaml: ")
    for command in ("show", "report", "task", "predict", "importance", "cutsets"):
        refused = inside(command, "robot.yaml")
        assert refused.returncode in (0, 3)
        if refused.returncode:
            assert refused.stderr.splitlines()[-1] == f"error: {says}"
    assert inside("show", "robot.yaml").returncode == 3


def test_what_commands_take_check_takes(inside: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    assert inside("check", "robot.yaml").returncode == 0
