"""What a fleet's design must be, so that its robots can be followed part by part."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from robophm.calibration.fleet import predict_fleet
from robophm.core.errors import SourceError
from robophm.simulation.fleet import simulate


@pytest.mark.parametrize("required", [1, 2])
def test_equal_parts_are_refused_in_words(required: int, tmp_path: Path) -> None:
    """One of two is replaced, and the other is as old as it was: one age of both would be wrong."""
    design = tmp_path / "robot.yaml"
    design.write_text(
        "schema_version: 1\nname: R\npowered: {topic: /power, field: on}\nusage: {operating: 0.3}\n"
        f"components:\n  wheel: {{rate: 0.05 /h, quantity: 2, required: {required}}}\n"
    )
    simulate(design, tmp_path / "fleet", 2, 1, 7)
    says = f"{tmp_path / 'fleet' / 'robot.yaml'}: wheel is 2 equal parts"
    with pytest.raises(SourceError, match=re.escape(says)):
        predict_fleet(tmp_path / "fleet")
