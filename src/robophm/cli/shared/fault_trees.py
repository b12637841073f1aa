"""The fault tree of a robot or of a model in the Open-PSA format, and how its minimal sets are shown."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block, Unit
from robophm.blocks.fault_tree import FaultTree
from robophm.cli.shared.output import console, print_table, table
from robophm.core.errors import RobophmError, StructureError, nearest
from robophm.design.importers.open_psa import Model, load
from robophm.design.robot import Robot
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.report import plain
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.life.exponential import Exponential
from robophm.report.minimal_sets import Listed
from robophm.report.words import number_text

_MOST_WRITTEN = 10**4000  # Python writes no number of more than 4,300 digits


@dataclass(frozen=True)
class System:
    """What is asked about: a tree, and the probabilities of its events."""

    name: str
    when: str
    tree: FaultTree
    occurred: npt.NDArray[np.float64]
    not_yet: npt.NDArray[np.float64]
    diagram: Block | None = None
    rates: dict[str, float] = field(default_factory=dict)
    """Of events that fail at a constant rate [1/h]."""
    model: Model | None = None
    """What it was read from, unless it is of a robot."""
    source: str = ""
    time: float | None = None
    unknown: PartsOfUnknownRate | None = None
    """Parts of unknown rate in it."""

    def fails(self, text: str) -> str:
        """How likely it has failed, in words."""
        return self.unknown.said("at least", text) if self.unknown else text

    @property
    def json(self) -> dict[str, Any]:
        """What every document about it says of parts of unknown rate."""
        return {"unknown": asdict(self.unknown)} if self.unknown else {}

    def print_unknown(self) -> None:
        """The same for people."""
        if self.unknown:
            console().print(self.unknown.of_sets, style="yellow", markup=False, soft_wrap=True)


def of_robot(robot: Robot, function: str | None, hours: float) -> System:
    """A robot, or a function of it, new and as designed, after so many operating hours."""
    if not math.isfinite(hours):
        raise RobophmError(f"{hours:g} h: expected a finite number")
    if function is not None and function not in robot.functions:
        raise RobophmError(f"no function '{function}'{nearest(function, robot.functions)}")
    when = f"after {number_text(hours)} h of operation, new and as designed"
    diagram = robot.functions[function] if function else robot.diagram
    tree, new = FaultTree.of(diagram), as_designed(Plant(robot))
    states = [new.survival_curve(Unit(name), np.array([hours])) for name in tree.names]
    rates: dict[str, float] = {}
    for part in robot.all_components():
        if all(isinstance(mode.life, Exponential) for mode in part.modes):
            each = math.fsum(robot.usage.per_operating_hour(mode.clock) * mode.share * mode.rate for mode in part.modes)
            calendar = any(mode.clock == "calendar" for mode in part.modes)
            if not calendar:
                rates |= dict.fromkeys(part.units, part.multiplicity * each)
    name = f"{robot.name}: {function}" if function else robot.name
    return System(
        name, when, tree,
        np.array([float(one.failed[0]) for one in states]), np.array([float(one.works[0]) for one in states]),
        diagram, rates, unknown=unknown(new, diagram),
    )  # fmt: skip


def of_model(path: Path, time: float | None, top: str | None) -> System:
    """A model in the Open-PSA format, at a mission time."""
    model = load(path, time, top)
    if model.tree is None:
        says = "always occurs" if model.certain else "never occurs"
        raise StructureError(f"{path}: '{model.name}' {says}: constants and house events decide it")
    when = f"at {number_text(time)} h" if time is not None else "as given"
    return System(model.name, when, model.tree, model.occurred, model.not_yet, model=model, source=path.name, time=time)


def sets_json(listed: Listed, whole: float) -> dict[str, Any]:
    """For machines; shares are of the ``whole``. What is beyond the numbers of JSON or Python's words is null."""
    counts = [n if n < _MOST_WRITTEN else None for n in (listed.count, *listed.by_order)]
    found = {
        "count": counts[0],
        "count_by_order": {str(i): n for i, n in enumerate(counts[1:], 1)},
        "sum_of_probabilities": listed.mass,
        "sum_of_those_not_listed": listed.neglected,
        "listed": [
            {"parts": list(one.names), "probability": one.probability,
             "share": one.probability / whole if whole > 0 else None}
            for one in listed.sets
        ],
    }  # fmt: skip
    return {key: plain(value) for key, value in found.items()}


def print_sets(listed: Listed, kind: str, whole: float) -> None:
    """For people."""
    out = console()
    out.print(listed.counted(kind), markup=False)
    rows = [
        (str(len(one.names)), f"{one.probability:.4g}",
         f"{100 * one.probability / whole:.3g} %" if whole > 0 else "–", ", ".join(one.names))
        for one in listed.sets
    ]  # fmt: skip
    print_table(out, table("", ("parts", "probability", "share", f"minimal {kind} set"), rows, figures=(0, 1, 2)))
    if listed.left_out():
        out.print(listed.left_out(), markup=False)
