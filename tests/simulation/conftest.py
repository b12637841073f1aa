from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.parts import completed
from robophm.simulation.design import Design
from robophm.simulation.design_file import read_design
from robophm.simulation.plan import Plans

HEAD = """\
schema_version: 1
name: small
usage: {operating: 0.5, cycles: 40 cycle/h, starts: 1 start/h}
powered: {topic: /power, field: on}
"""

FLEET = Path(__file__).resolve().parents[2] / "examples" / "fleet" / "robot.yaml"


@pytest.fixture
def design(tmp_path: Path) -> Callable[[str], Design]:
    """The design of a few lines beneath the usual head."""

    def read(text: str) -> Design:
        path = tmp_path / "robot.yaml"
        path.write_text(HEAD + text)
        return read_design(path, completed)

    return read


@pytest.fixture
def same_plan() -> Callable[..., Plans]:
    """One plan for many robots: tasks of legs (seconds, speed, names of functions or none, stresses)."""

    def plans(design: Design, robots: int, every: float, tasks: Sequence[Sequence[tuple[Any, ...]]]) -> Plans:
        shape = (len(tasks), 3)
        seconds, speed = np.zeros(shape), np.zeros(shape)
        needs = np.zeros((*shape, len(design.functions) + 1), dtype=bool)
        stress = np.full((*shape, len(design.signals)), 25.0)
        for i, legs in enumerate(tasks):
            for k, (length, velocity, names, *stresses) in enumerate(legs):
                seconds[i, k], speed[i, k] = length, velocity
                needs[i, k] = [name in (names or ()) for name in design.functions] + [not names]
                stress[i, k] = stresses or stress[i, k]
        count = np.full(robots, len(tasks))
        arrays = (np.repeat(one[None], robots, axis=0) for one in (seconds, speed, needs, stress))
        return Plans(np.full(robots, every), count, *arrays)

    return plans
