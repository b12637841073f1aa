"""Fault trees and minimal sets, of a robot or of a model in the Open-PSA format."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.diagram import Block, Unit
from robophm.blocks.fault_tree import FaultTree
from robophm.cli.output import console, estimate_text, print_json, print_table, table, write
from robophm.cli.unused import refuse_unused
from robophm.core.errors import RobophmError, StructureError, nearest
from robophm.design.file import load as load_design
from robophm.design.importers.open_psa import Model, load
from robophm.design.importers.open_psa.as_design import as_design
from robophm.design.importers.open_psa.writing import document
from robophm.design.robot import Robot
from robophm.health.plant import Plant
from robophm.health.prognosis import as_designed
from robophm.health.report import plain
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.life.exponential import Exponential
from robophm.report.minimal_sets import Listed
from robophm.report.words import number_text, probability_text

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


def cut_sets(system: System, *, paths: bool, order: int | None, most: int, as_json: bool) -> None:
    """List the minimal cut sets, or path sets, of a robot."""
    probability = float(system.tree.probability(system.occurred, system.not_yet))
    if paths and system.diagram is not None:
        sets = MinimalSets.paths(system.diagram)
        place = {name: i for i, name in enumerate(system.tree.names)}
        listed = Listed(sets, system.not_yet[[place[name] for name in sets.names]], most, order)
        share_of = 1.0 - probability
    else:
        listed, share_of = Listed(MinimalSets(system.tree), system.occurred, most, order), probability
    kind = "path" if paths else "cut"
    if as_json:
        print_json({"system": system.name, "when": system.when, "unreliability": probability,
                    f"{kind}_sets": _json(listed, share_of), **system.json})  # fmt: skip
        return
    out = console()
    has_failed = system.fails(probability_text(probability))
    out.print(f"{system.name}, {system.when}: has failed with {has_failed}", markup=False, soft_wrap=True)
    system.print_unknown()
    _show(listed, kind, share_of)


def tree(system: System, *, order: int | None, most: int, to: Path | None, as_json: bool) -> None:
    """State the probability of the top event, list the cut sets of a coherent tree, and write it where wanted.

    What is written is a model in the Open-PSA format, or where its name ends as a design's does, a design.
    """
    if to and system.unknown:
        raise RobophmError(f"{to}: {system.unknown.words} would be written as never failing; expected a rate for each")
    text = _design(system, to) if to and is_design(to) else ""
    probability = float(system.tree.probability(system.occurred, system.not_yet))
    listed = Listed(MinimalSets(system.tree), system.occurred, most, order) if system.tree.coherent else None
    if to:
        write(to, text or document(system.name, system.tree, list(map(float, system.occurred)), system.rates))
    size = {"basic_events": len(system.tree.names), "gates": len(system.tree.gates) - len(system.tree.names)}
    if as_json:
        print_json({
            "top_event": system.name, "when": system.when, "probability": probability, **size,
            "modules": len(system.tree.modular.parts), "nodes": system.tree.modular.size,
            "coherent": system.tree.coherent, "cut_sets": _json(listed, probability) if listed else None,
            **system.json,
        })  # fmt: skip
        return
    out = console()
    out.print(
        f"{system.name}, {system.when}: occurs with {system.fails(f'{probability:.6g}')}", markup=False, soft_wrap=True
    )
    system.print_unknown()
    out.print(f"{size['basic_events']} basic events, {size['gates']} gates; solved as {len(system.tree.modular.parts)} "
              f"modules by {system.tree.modular.size} nodes", markup=False)  # fmt: skip
    if listed:
        _show(listed, "cut", probability)
    else:
        out.print(
            "It has 'not' or 'xor' gates: no minimal cut sets are listed, the probability is exact.", markup=False
        )
    if to:
        out.print(f"Written: {to}", markup=False)


def estimated(system: System, samples: int, seed: int, *, as_json: bool) -> None:
    """State how often the top event occurred in so many samples of the basic events."""
    from robophm.groups.monte_carlo import simulate_tree

    found = simulate_tree(system.tree, system.occurred.tolist(), samples, seed=seed)
    if as_json:
        print_json({"top_event": system.name, "when": system.when, "seed": seed, **asdict(found), **system.json})
        return
    console().print(
        f"{system.name}, {system.when}: occurs with {system.fails(estimate_text(found))} ({found.samples:,} samples)",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    system.print_unknown()


def system_of(source: Path, function: str | None, top: str | None, time: float | None, *, by_chance: bool) -> System:
    """What a file holds, a robot's design or a model; what does not go with that, or with --monte-carlo, is refused."""
    robot = is_design(source)
    path = "a robot, whose top event is of --function" if robot else "a model, whose top event is of --top"
    path += ", only estimated (--monte-carlo)" if by_chance else ""
    given = ("monte_carlo", "seed") if by_chance else ("order", "most", "to")
    refuse_unused(path, ("time", "function" if robot else "top", *given))
    if robot:
        return of_robot(load_design(source), function, 1000.0 if time is None else time)
    return of_model(source, time, top)


def is_design(path: Path) -> bool:
    """Whether a file is a design by its name."""
    return path.suffix.lower() in (".yaml", ".yml")


def _design(system: System, to: Path) -> str:
    if system.model is None:
        raise RobophmError(f"{to}: of a robot its fault tree is written; expected a name that ends in .xml")
    if to.exists():
        raise RobophmError(f"{to}: exists already; expected the name of a new design")
    return as_design(system.model, system.source, system.time)


def _json(listed: Listed, whole: float) -> dict[str, Any]:
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


def _show(listed: Listed, kind: str, whole: float) -> None:
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
