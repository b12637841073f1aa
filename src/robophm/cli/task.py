"""``robophm task``: can this robot do these tasks, how sure is that, and what decides it"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

from robophm.cli import BREACHED
from robophm.cli.shared import task_recording
from robophm.cli.shared.health_output import print_wear
from robophm.cli.shared.options import Design, Draws, Failed, Future, Json, Legacy, SkipMissing, Store, Working
from robophm.cli.shared.output import console, print_json, print_table, progress_console, table, warn
from robophm.cli.shared.progress import counted
from robophm.cli.shared.stored_past import check_draws, kept
from robophm.cli.shared.task_words import stated_speed
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.design.build_task import with_knowledge
from robophm.design.file import load
from robophm.design.importers.legacy.figures import LegacyTask, UnitMode, legacy_tasks
from robophm.design.robot import Robot
from robophm.design.task import Plan, Task
from robophm.design.task_file import load_plan
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, repetitions
from robophm.health.outlooks import FutureName, View, outlooks
from robophm.health.prognosis import Outlook
from robophm.health.repeated_tasks import RepeatedTasks
from robophm.health.report import VIEWS
from robophm.health.task_report import TaskReport, task_report
from robophm.health.uncertainty import Interval
from robophm.health.unknown_rates import marks
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.seen_wear import seen_wear
from robophm.report.words import duration_text, failure_text, number_text, percent_text, probability_text
from robophm.transports.recordings.files import holds_messages
from robophm.transports.recordings.remote import here
from robophm.transports.recordings.salvage import Salvage

MOST_NAMED = 5
"""Components that are named one by one."""

LEAST_NAMED = 0.005
"""Share of the failures from which on a component is named."""

MOST_LISTED = 200
"""Tasks that are listed one by one."""

_ALWAYS = ("tasks", "store", "failed", "working", "legacy")  # used, whether tasks are listed or recorded


@dataclass(frozen=True)
class Request:
    """The options as they were written on the command line."""

    tasks: Path | None
    store: str | None
    failed: tuple[str, ...]
    working: tuple[str, ...]
    future: str
    repeat: int
    threshold: float | None
    draws: int
    seed: int
    topic: tuple[str, ...]
    speed: str | None
    function: tuple[str, ...]
    skip_missing: bool
    legacy: bool
    as_json: bool


def command(
    design: Design,
    tasks: Annotated[
        Path | None, typer.Argument(help="tasks, .yaml or .csv, or a recording; default: the design's task")
    ] = None,
    store: Store = None,
    failed: Failed = None,
    working: Working = None,
    future: Future = "recent",
    repeat: Annotated[
        int, typer.Option(help="number of times that the list is done, one after the other", min=1, max=1_000_000)
    ] = 1,
    threshold: Annotated[
        float | None,
        typer.Option(help="lowest acceptable probability, for --repeat; default: the design's", min=0, max=1),
    ] = None,
    draws: Draws = 2000,
    seed: Annotated[int, typer.Option(help="random seed")] = 0,
    topic: Annotated[
        list[str] | None,
        typer.Option(help="of a recording: topic or action that announces tasks, or gives the robot's position"),
    ] = None,
    speed: Annotated[str | None, typer.Option(help="speed for planned legs of a recording that state none")] = None,
    function: Annotated[list[str] | None, typer.Option(help="function that the tasks of a recording need")] = None,
    skip_missing: SkipMissing = False,
    legacy: Legacy = False,
    as_json: Json = False,
) -> None:
    """The probability that each task will be completed, and the parts that decide it."""
    request = Request(
        tasks, store, tuple(failed or ()), tuple(working or ()), future, repeat, threshold, draws, seed,
        tuple(topic or ()), speed, tuple(function or ()), skip_missing=skip_missing, legacy=legacy, as_json=as_json,
    )  # fmt: skip
    if run(design, request):
        raise typer.Exit(BREACHED)


def run(design: Path, asked: Request) -> bool:
    """Print the answer; return whether a threshold is breached."""
    robot, tasks = load(design), here(asked.tasks) if asked.tasks else None
    check_draws(asked.draws, robot)
    chosen: Any = asked.future
    for name in asked.function:
        robot.diagram_of(name)  # which must be there
    ledger = kept(asked.store, robot) if asked.store else None
    if tasks is not None and (tasks.is_dir() or holds_messages(tasks)):
        refuse_unused("the tasks of a recording", (*_ALWAYS, "topic", "speed", "function", "skip_missing"))
        knowledge = with_knowledge(Plan(()), robot, asked.failed, asked.working).knowledge
        at = stated_speed(asked.speed)
        with Salvage(tasks) as source:
            breached = task_recording.run(
                robot, ledger, source, asked.topic, speed=at, functions=asked.function, knowledge=knowledge,
                skip_missing=asked.skip_missing, legacy=asked.legacy, as_json=asked.as_json,
            )  # fmt: skip
    else:
        if tasks is None and robot.task is None:
            raise RobophmError(f"{design}: has no task; expected one in it, or a tasks file")
        again, drawn = ["threshold"] * (asked.repeat > 1), ["seed"] * (asked.draws > 0)
        path = "a list of tasks" + " that is done once, by the design's threshold" * (asked.repeat == 1)
        refuse_unused(path, (*_ALWAYS, "future", "repeat", "draws", *again, *drawn))
        plan = load_plan(tasks, robot) if tasks else robot.plan
        plan = with_knowledge(plan, robot, asked.failed, asked.working)
        question = Question(plan, chosen, asked.repeat, asked.threshold, asked.draws, asked.seed, asked.legacy)
        breached = _of_list(robot, ledger, question, as_json=asked.as_json)
    return breached


@dataclass(frozen=True)
class Question:
    """The question as the options state it."""

    plan: Plan
    future: FutureName
    repeat: int
    threshold: float | None
    draws: int
    seed: int
    legacy: bool = False
    """Whether to show what the 2020 tool says."""


def _of_list(robot: Robot, ledger: Ledger | None, question: Question, *, as_json: bool) -> bool:
    """Print the answer; return whether a threshold is breached."""
    monitor = Monitor(robot, ledger)
    settled = monitor.exposure.settled(monitor.ledger)
    wear = seen_wear(robot, settled)
    report = task_report(
        monitor.plant, monitor.exposure, settled, question.plan,
        future=question.future, draws=question.draws, seed=question.seed, wear=wear,
    )  # fmt: skip
    again: dict[View, tuple[RepeatedTasks, bool]] = {}
    if question.repeat > 1:
        views = outlooks(
            monitor.plant, monitor.exposure, settled,
            future=question.future, knowledge=question.plan.knowledge, wear=wear,
        )  # fmt: skip
        again = {view: _repeated(views[view], question.plan, question.repeat) for view in VIEWS}
    threshold = question.threshold if question.threshold is not None else report.threshold
    uptime = float(settled.clocks.value[0])
    old = legacy_tasks(robot, question.plan.joined, uptime, question.repeat) if question.legacy else {}
    if as_json:
        more = {"repetitions": _json(again, threshold)} if again else {}
        more |= {"legacy": {unit: asdict(one) for unit, one in old.items()}} if old else {}
        print_json({**report.to_json(), **more})
    else:
        _print(report, again, threshold, question)
        print_wear(report.wear, monitor.plant)
        if old:
            _print_legacy(report, old)
    return report.breached


def _print_legacy(report: TaskReport, old: Mapping[UnitMode, LegacyTask]) -> None:
    exact = report.together["nominal"]
    rows = [("exact, nominal", "", probability_text(exact.probability, exact.failure), "")]
    for unit, one in old.items():
        last = percent_text(one.prognostic[-1]) if len(one.prognostic) > 2 else ""
        rows.append((f"2020 tool in {unit} mode", percent_text(one.reliability), percent_text(one.predicted), last))
    title = "All of it by the 2020 tool: R of the robot, then R to the power of the last leg's distance"
    columns = ("", "R before", "predicted PoTC", "after the last repetition")
    print_table(console(), table(title, columns, rows, figures=(1, 2, 3)))


def _repeated(outlook: Outlook, plan: Plan, count: int) -> tuple[RepeatedTasks, bool]:
    """All repetitions, or those before the user's interrupt; and whether there was one."""
    found, interrupted = [], False
    with counted(progress_console(), "repetitions") as advance:
        try:
            for chunk in repetitions(outlook, plan.tasks, count, plan.gap):
                found.append(chunk)
                advance(sum(one.shape[1] for one in found), count)
        except KeyboardInterrupt:
            interrupted = True
    return RepeatedTasks.of(found, count), interrupted


def _json(again: Mapping[View, tuple[RepeatedTasks, bool]], threshold: float | None) -> dict[str, Any]:
    return {
        view: {
            "probability": one.probability.tolist(),
            "failure": one.failure.tolist(),
            "cut_short": one.cut_short,
            "below_threshold_at": one.first_below(threshold) if threshold is not None else None,
        }
        for view, (one, _) in again.items()
    } | {"threshold": threshold}


def _print(
    report: TaskReport, again: Mapping[View, tuple[RepeatedTasks, bool]], threshold: float | None, question: Question
) -> None:
    out = console()
    _print_tasks(out, report)
    if_never = f", {report.unknown.if_never}" if report.unknown else ""
    if report.unknown:
        out.print(report.unknown.of_tasks, style="yellow", markup=False, soft_wrap=True)
    known = question.plan.knowledge
    for what, units in (("have failed", known.failed), ("work", known.working)):
        if units:
            some = ", ".join(sorted(units)[:MOST_NAMED]) + (" …" if len(units) > MOST_NAMED else "")
            out.print(f"Known to {what}: {len(units)} part{'s' * (len(units) != 1)} ({some})", markup=False)
    _print_uncertainty(out, report, if_never, drawn=question.draws > 0)
    shares = [
        f"{one.path} {percent_text(one.share)}" for one in report.deciding[:MOST_NAMED] if one.share > LEAST_NAMED
    ]
    if shares:
        out.print(f"Decided by (share of the failures that would vanish): {', '.join(shares)}{if_never}", markup=False)
    for view, (one, interrupted) in again.items():
        _print_repeated(out, view, one, threshold, if_never, interrupted=interrupted)
    if report.breached:
        out.print(f"threshold breached: a task is below {percent_text(report.threshold or 0)}", style="bold red")


def _print_tasks(out: Console, report: TaskReport) -> None:
    mark = marks(report.unknown)[2]

    def row(name: str, task: Task, nominal: Completion, lived: Completion) -> list[str]:
        figures = (mark + probability_text(one.probability, one.failure) for one in (nominal, lived))
        way = [f"{number_text(task.distance)} m"] if driven else []
        return [name, *way, duration_text(task.duration), str(len(task.legs)), *figures]

    whole = Task.joined(one.task for one in report.tasks)
    driven = whole.distance > 0
    failure = np.array([one.sensor_based.failure for one in report.tasks])
    listed = np.sort(np.argsort(-failure, kind="stable")[:MOST_LISTED])
    shown = [(i + 1, report.tasks[i]) for i in listed]
    rows = [row(one.task.name or f"task {i}", one.task, one.nominal, one.sensor_based) for i, one in shown]
    if len(report.tasks) > 1:
        rows.append(row("all of them", whole, *(report.together[view] for view in VIEWS)))
    columns = ["", *(["distance"] if driven else []), "time", "legs", "PoTC nominal", "PoTC sensor-based"]
    title = f"Can {report.robot} do this?"
    print_table(out, table(title, columns, rows, figures=range(1, len(columns))))
    if len(shown) < len(report.tasks):
        out.print(
            f"Listed are the {len(shown)} likeliest to fail of {len(report.tasks):,} tasks; --json has all of them"
        )


def _print_uncertainty(out: Console, report: TaskReport, if_never: str, *, drawn: bool) -> None:
    exact = f"{'Known rates' if report.unknown else 'Rates'} and load are taken as exact"
    sure = report.uncertainty
    if sure is None:
        why = "no `uncertainty` in the design, too short a past" if drawn else "--draws 0"
        out.print(f"{exact} ({why}).")
        return
    past = ", the load drawn from its past" if sure.of_load else ""
    out.print(f"All of it fails {_between(sure.failure, 'between ')} (90 %{past}){if_never}", markup=False)
    if sure.of_rates and sure.of_load:
        out.print(f"  if rates were known exactly: {_between(sure.failure_if_rates_known)}{if_never}", markup=False)
        out.print(
            f"  if the load stayed as it was recently: {_between(sure.failure_if_load_known)}{if_never}", markup=False
        )


def _between(interval: Interval, between: str = "") -> str:
    low, high = (failure_text(failure) for failure in (interval.low, interval.high))
    return (between and "about ") + low if low == high else f"{between}{low} and {high}"


def _print_repeated(
    out: Console, view: View, one: RepeatedTasks, threshold: float | None, if_never: str, *, interrupted: bool
) -> None:
    count = len(one.probability)
    name = view.replace("_", "-")
    if interrupted:
        warn(f"{name}: interrupted after {count:,} repetitions")
    elif one.cut_short:
        warn(f"{name}: ends after {count:,} repetitions; that so many succeed is less likely than 1 in 10^290")
    if not count:
        return
    first, last = (probability_text(one.probability[i], one.failure[i]) for i in (0, -1))
    whole = percent_text(one.together.probability, one.together.failure)
    text = f"{count:,} times, {name}: the first {first}, the last {last}, all {whole}"
    if threshold is not None:
        at = one.first_below(threshold)
        text += f"; below {percent_text(threshold)} " + (f"at repetition {at:,}" if at else "never")
    out.print(text + if_never, markup=False)
