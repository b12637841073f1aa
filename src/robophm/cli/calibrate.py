"""``robophm calibrate``: whether predictions were honest."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from robophm.calibration.fleet import CONTROLS, OURS, files, predict_fleet
from robophm.calibration.honest_past import honest_past
from robophm.calibration.lives import LifeScore, Prognosis
from robophm.calibration.predictions import Predictions, read_predictions
from robophm.calibration.score import Calibration, score
from robophm.calibration.tasks import TaskScore
from robophm.cli import BREACHED
from robophm.cli.shared.options import Json, stated_store
from robophm.cli.shared.output import console, may_write, print_json, print_table, progress_console, table, write
from robophm.cli.shared.progress import counted
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.design.file import load
from robophm.health.plant import Plant
from robophm.monitoring.stored_past import stored_past
from robophm.report.calibration_page import calibration_page
from robophm.report.words import duration_text, moment_text, number_text

TASKS = ("model", "tasks", "failed", "expected", "Brier", "reliability", "resolution", "log. score", "p")
LIVES = ("model", "lives", "censored", "in 50 %", "in 80 %", "in 95 %", "CRPS", "p")
PROGNOSIS = ("model", "lives", "horizon", "α–λ half way", "relative accuracy", "convergence")


def of_fleet(folder: Path, *, controls: bool, jobs: int) -> Predictions:
    """Return our model's predictions for a fleet, task by task; with ``controls`` also models that are wrong."""
    models = OURS | CONTROLS if controls else OURS
    with counted(progress_console(), "predicting") as on_robot:
        return predict_fleet(folder, models, jobs=jobs, on_robot=on_robot)


def print_calibration(out: Console, calibration: Calibration) -> None:
    """Print the verdicts, then the scores of all models."""
    for one in calibration.models:
        for kind, verdict in (("tasks", one.task_verdict), ("remaining life", one.life_verdict)):
            if verdict:
                style = "bold red" if verdict.finding == "not calibrated" else None
                out.print(f"{one.model}, {kind}: {verdict}", style=style, markup=False)
    models = calibration.models
    if rows := [_task_row(one.model, one.tasks) for one in models if one.tasks]:
        print_table(out, table("Task completion", TASKS, rows, figures=range(1, len(TASKS))))
    if rows := [_life_row(one.model, one.lives) for one in models if one.lives]:
        print_table(out, table("Remaining life", LIVES, rows, figures=range(1, len(LIVES))))
    if rows := [_prognosis_row(one.model, one.lives.prognosis) for one in models if one.lives and one.lives.prognosis]:
        print_table(out, table("Prognosis", PROGNOSIS, rows, figures=range(1, len(PROGNOSIS))))


def _task_row(model: str, score: TaskScore) -> list[str]:
    brier = score.brier
    figures = (score.expected, brier.score, brier.reliability, brier.resolution, score.logarithmic_score)
    return [model, f"{score.tasks:,}", f"{score.failed:,}", *map(number_text, figures), number_text(score.p_value, 2)]


def _life_row(model: str, score: LifeScore) -> list[str]:
    held = [f"{100 * one.share:.1f} %" for one in score.coverage]
    last = (duration_text(score.crps), number_text(score.p_value, 2))
    return [model, f"{score.lives:,}", f"{score.censored:,}", *held, *last]


def _prognosis_row(model: str, found: Prognosis) -> list[str]:
    shares = [f"{number_text(100 * share, 3)} %" for share in (found.horizon, found.half_way)]
    return [model, f"{found.lives:,}", *shares, number_text(found.relative_accuracy), duration_text(found.convergence)]


def command(
    predictions: Annotated[
        Path,
        typer.Argument(
            help="a table of predictions and outcomes, a fleet's folder, or a robot's design with --store",
            metavar="PREDICTIONS.CSV|FLEET|ROBOT.YAML",
        ),
    ],
    store: Annotated[
        str | None,
        typer.Option(help="of a robot: store with its past, written by replay or watch", callback=stated_store),
    ] = None,
    report: Annotated[Path | None, typer.Option(help="write an HTML page about it")] = None,
    controls: Annotated[
        bool,
        typer.Option("--controls", help="of a fleet: also score models that are wrong, to see that they are detected"),
    ] = False,
    jobs: Annotated[int, typer.Option(help="of a fleet: number of processes", min=1, max=256)] = 1,
    as_json: Json = False,
) -> None:
    """Compare predictions with what happened, and say whether they were honest."""
    if store is not None:
        refuse_unused("a robot's past", ("predictions", "store"))
        _of_past(predictions, store, as_json=as_json)
        return
    if predictions.suffix in (".yaml", ".yml"):
        raise RobophmError(f"{predictions}: is a design; expected its past too: --store")
    if predictions.is_dir():
        may_write(report, *files(predictions))
        said = of_fleet(predictions, controls=controls, jobs=jobs)
    else:
        refuse_unused("a file of predictions, which has the models that it has", ("report",))
        may_write(report, predictions)
        said = read_predictions(predictions)
    calibration = score(said)
    if report:
        write(report, calibration_page(calibration, predictions.name))
    if as_json:
        print_json(calibration.to_json())
    else:
        print_calibration(console(), calibration)
        if report:
            console().print(f"Report: {report}", markup=False)
    if calibration.rejected:
        raise typer.Exit(BREACHED)


def _of_past(design: Path, store: str, *, as_json: bool) -> None:
    """Say whether a robot failed as often as its kept figures promised; leave with BREACHED where that is refuted."""
    robot = load(design)
    with stored_past(store, robot) as (kept, ledger):
        found = honest_past(Plant(robot), kept.history(robot.identity), ledger)
    if as_json:
        spans = [one.to_json() for one in found.spans]
        print_json({"schema_version": 1, "robot": robot.name, "spans": spans, "of_others": found.of_others})
    else:
        out = console()
        for one in found.spans:
            designed = "" if one.designed is None else f" (as designed {number_text(one.designed, 2)})"
            out.print(
                f"{robot.name}, since {moment_text(one.since)}: {one.counted.says}{designed}",
                style="bold red" if one.rejected else None, markup=False, soft_wrap=True,
            )  # fmt: skip
        if not found.spans:
            out.print(
                f"{robot.name}: not to be told; expected two reports at least, no part of unknown rate, and figures "
                "that were not revised meanwhile", markup=False, soft_wrap=True,
            )  # fmt: skip
        if found.of_others:
            out.print(f"Not counted: {found.of_others} of parts without which it goes on", markup=False)
    if any(one.rejected for one in found.spans):
        raise typer.Exit(BREACHED)
