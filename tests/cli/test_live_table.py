"""The table of a robot that is watched, in terminals of any width."""

from __future__ import annotations

from pathlib import Path

import pytest
from rich.console import Console

from robophm.cli.shared.live_table import LiveTable
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor

OTA = Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml"


@pytest.mark.parametrize(("width", "heads"), [
    (60, ["sensor", "RUL", "PoTC"]),
    (80, ["λ nominal", "λ sensor", "R sensor", "RUL", "PoTC"]),
    (100, ["λ nominal", "λ sensor", "R nominal", "R sensor", "RUL", "PoTC"]),
    (140, ["λ nominal", "λ sensor", "R nominal", "R sensor", "RUL", "PoTC", "λ sensor, recent"]),
])  # fmt: skip
def test_names_and_figures_are_whole_at_any_width(width: int, heads: list[str]) -> None:
    robot = load(OTA)
    report, shown = Monitor(robot).report(), LiveTable()
    for _ in range(24):
        drawn = shown.draw(report)
    console = Console(width=width)
    with console.capture() as said:
        console.print(drawn)
    _, head, *rows = said.get().splitlines()
    assert all(one in head for one in heads)
    assert [row.split()[0] for row in rows[:-1]] == ["OTA", *(module.name for module in robot.modules)]
    assert all(len(row.rstrip()) <= width for row in rows)
    whole = f"{report.system.sensor_based.hazard_rate:.3e}".replace("e-0", "e-")
    assert whole in rows[0]
