"""``robophm importance``: what matters most to a robot, and what to replace first"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, cast

import typer

from robophm.cli.shared.option_hints import with_options
from robophm.cli.shared.options import Failed, Future, Json, Store, Working, time_option
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.stored_past import kept
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError, nearest
from robophm.core.json_values import plain
from robophm.design.build_task import with_knowledge
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.design.task import Plan
from robophm.design.task_file import load_plan
from robophm.health.importance import Importances, of_tree
from robophm.health.ledger import Ledger
from robophm.health.outlooks import FutureName, View, outlooks
from robophm.health.replacement import Replacements
from robophm.health.report import VIEWS
from robophm.health.what_matters import what_matters
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.seen_wear import seen_wear
from robophm.report.fault_trees import of_model
from robophm.report.words import duration_text, more_text, number_text, percent_text, probability_text, share_text

MEASURES = {
    "birnbaum": "birnbaum",
    "criticality": "criticality",
    "fussell-vesely": "fussell_vesely",
    "raw": "achievement",
    "rrw": "reduction",
    "improvement": "improvement",
    "barlow-proschan": "barlow_proschan",
}
"""Measures that parts may be ranked by, and what each is called inside."""


@dataclass(frozen=True)
class Question:
    """The question as the options state it."""

    plan: Plan
    future: str
    function: str | None
    hours: float | None
    """Hours of operation ahead; None: the usual."""
    by: str
    most: int


def measure(name: str) -> str:
    """Return what a measure is called inside. Raises RobophmError."""
    if name not in MEASURES:
        raise RobophmError(f"--by {name}: no such importance{nearest(name, MEASURES)}")
    return MEASURES[name]


def command(
    design: Annotated[Path, typer.Argument(help="a robot's design file, or an Open-PSA model", metavar="ROBOT.YAML")],
    tasks: Annotated[Path | None, typer.Argument(help="tasks, .yaml or .csv; default: the design's task")] = None,
    store: Store = None,
    failed: Failed = None,
    working: Working = None,
    future: Future = "recent",
    function: Annotated[str | None, typer.Option(help="function of the robot; default: the whole robot")] = None,
    hours: Annotated[
        float | None, time_option("--within", "operating time; default: 1000 h, or half its life if less", above=True)
    ] = None,
    by: Annotated[str, typer.Option(help="measure: birnbaum, criticality, fussell-vesely, raw, rrw, improvement "
                                         "or barlow-proschan")] = "criticality",
    most: Annotated[int, typer.Option(help="number of parts to list", min=1, max=100_000)] = 20,
    as_json: Json = False,
) -> None:  # fmt: skip
    """Rank parts by their importance to a robot's health, and say what to replace first."""
    ranked = measure(by)
    if design.suffix.lower() == ".xml":
        run_model(design, hours, ranked, most, as_json=as_json)
        return
    robot = load(design)
    plan = load_plan(tasks, robot) if tasks else robot.plan
    plan = with_knowledge(plan, robot, failed or (), working or ())
    run(robot, kept(store, robot) if store else None, Question(plan, future, function, hours, ranked, most),
        as_json=as_json)  # fmt: skip


def run(robot: Robot, ledger: Ledger | None, question: Question, *, as_json: bool) -> None:
    """Print the answer for a robot."""
    diagram = robot.diagram_of(question.function)
    monitor = Monitor(robot, ledger)
    settled = monitor.exposure.settled(monitor.ledger)
    plan = question.plan
    views = outlooks(
        monitor.plant, monitor.exposure, settled, future=cast(FutureName, question.future), knowledge=plan.knowledge,
        wear=seen_wear(robot, settled),
    )  # fmt: skip
    wanted: Sequence[View] = VIEWS if ledger else ("sensor_based",)  # without a past both are one
    task = plan.joined if plan.tasks else None
    found = what_matters({view: views[view] for view in wanted}, diagram, task, question.hours)
    name = f"{robot.name}: {question.function}" if question.function else robot.name
    if as_json:
        print_json({
            "system": name,
            "importance": {view: _json(one, question) for view, one in found.importances.items()},
            "replacement": {view: plain({**asdict(one), "parts": [asdict(part) for part in one.parts[: question.most]]})
                            for view, one in found.replacements.items()},
        })  # fmt: skip
        return
    seen = "sensor-based, given what is known now" if ledger else "new and as designed"
    _show(f"{name}, {seen}", found.importances["sensor_based"], question, found.importances.get("nominal"))
    _show_gains(found.replacements["sensor_based"], question)


def run_model(path: Path, hours: float | None, by: str, most: int, *, as_json: bool) -> None:
    """Print the answer for a coherent fault tree in the Open-PSA format."""
    refuse_unused("a fault tree", ("hours", "by", "most"))
    system = of_model(path, hours)
    found = of_tree(system.event, math.nan if hours is None else hours)
    question = Question(Plan(()), "nominal", None, hours, by, most)
    if as_json:
        print_json({"system": system.name, "importance": {"as_given": _json(found, question)}})
    else:
        _show(f"{system.name}, {system.when}", found, question)


def _json(found: Importances, question: Question) -> Any:
    units = [asdict(one) for one in found.ranked(question.by)[: question.most]]
    return plain({**asdict(found), "by": question.by, "count": len(found.units), "units": units})


def _show(title: str, found: Importances, question: Question, nominal: Importances | None = None) -> None:
    out = console()
    if found.has_failed:
        out.print(f"{title}: has failed; no part matters more than another", markup=False, soft_wrap=True)
        return
    ahead = f"within {number_text(found.hours)} h of operation " if found.lifelong else ""
    left_out, fails = found.unknown, percent_text(found.failure)
    says = left_out.said(left_out.failing, fails) if left_out else fails
    out.print(f"{title}: fails {ahead}with {says}", markup=False, soft_wrap=True)
    if left_out:
        out.print(left_out.aside, style="yellow", markup=False, soft_wrap=True)
    columns = ["most important first", "Birnbaum", "criticality", "F–V", "RAW", "RRW", "improvement"]
    columns += [*(["causes"] if found.lifelong else []), *(["crit. nominal"] if nominal else [])]
    designed = {one.unit: one for one in nominal.units} if nominal else {}
    rows = []
    for one in found.ranked(question.by)[: question.most]:
        row = [one.unit, number_text(one.birnbaum), share_text(one.criticality), share_text(one.fussell_vesely)]
        row += [number_text(one.achievement), number_text(one.reduction), number_text(one.improvement)]
        row += [share_text(one.barlow_proschan)] if found.lifelong else []
        rows.append(row + ([share_text(designed[one.unit].criticality)] if nominal else []))
    print_table(out, table("", columns, rows, figures=range(1, len(columns))))
    if len(rows) < len(found.units):
        more = more_text(len(found.units) - len(rows), "listed")
        out.print(f"{more} (--most); --by ranks by another importance")
    if found.lifelong:
        ever = "" if found.ever > 1 - 1e-6 else f", which comes with {percent_text(found.ever)}"
        out.print(f"causes: share of all failures to come that its own failure brings about (Barlow–Proschan){ever}")
    if found.refused:
        out.print(f"No F–V: {with_options(found.refused)}", style="yellow", markup=False)


def _show_gains(found: Replacements, question: Question) -> None:
    out = console()
    as_it_is = f"median remaining life {duration_text(found.median)}, mean {duration_text(found.mean)}"
    if found.completion_failure is not None:
        chance = probability_text(1 - found.completion_failure, found.completion_failure)
        as_it_is += f"; the task is completed with {chance}"
    said = found.unknown.said_ahead(as_it_is) if found.unknown else as_it_is
    out.print(f"\nWhat to replace first. As it is: {said}", markup=False, soft_wrap=True)
    if found.unknown:
        out.print(found.unknown.aside, style="yellow", markup=False, soft_wrap=True)
    some = found.changing
    if not some:
        out.print("Nothing gains by being replaced: no part has aged, and no redundancy is lost.")
        return
    with_task = found.completion_failure is not None
    columns = ["replaced now by a new one", *(["PoTC"] if with_task else []), "median life", "mean life"]
    rows = [
        [one.path, *([_signed(one.completion or 0.0, number_text)] if with_task else []),
         _signed(one.median, duration_text), _signed(one.mean, duration_text)]
        for one in some[: question.most]
    ]  # fmt: skip
    print_table(out, table("", columns, rows, figures=range(1, len(columns))))
    if len(some) > len(rows):
        out.print(f"{more_text(len(some) - len(rows), 'listed')} (--most)")
    if found.losing:
        out.print(f"{found.losing:,} would lose: young parts of theirs fail more often than old ones")
    if len(some) < len(found.parts):
        out.print(f"{len(found.parts) - len(some):,} more would change nothing")
    if found.others:
        out.print(f"{found.others:,} parts that matter less were not looked at")


def _signed(value: float, text: Callable[[float], str]) -> str:
    if math.isnan(value) or value == 0:
        return "–" if math.isnan(value) else "0"
    return ("+" if value > 0 else "-") + text(abs(value))
