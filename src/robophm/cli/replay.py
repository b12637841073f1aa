"""``robophm replay``: a robot's health after what it recorded."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli import BREACHED
from robophm.cli.shared.health_output import print_report
from robophm.cli.shared.options import Design, GrowingStore, Horizon, Json, SkipMissing, Unit, horizon_of
from robophm.cli.shared.output import console, may_write, print_json, progress_console, warn, write
from robophm.cli.shared.progress import progress
from robophm.cli.shared.stored_past import files_of
from robophm.cli.shared.unused import refuse_unused
from robophm.design.file import load
from robophm.monitoring.recording_sessions import sessions_of
from robophm.monitoring.replay import MOST_JOBS, replay_sessions
from robophm.monitoring.told_past import told_past
from robophm.report.health_page import health_page
from robophm.stores import open_store
from robophm.stores.memory import MemoryStore
from robophm.stores.store import Store


def command(
    design: Design,
    recordings: Annotated[
        list[Path],
        typer.Argument(
            help="recordings: .bag, .db3, .mcap, .csv, .journal, or folders; or addresses: https://, s3://, gs://, az://"
        ),
    ],
    store: GrowingStore = None,
    report: Annotated[Path | None, typer.Option(help="write an HTML page about the robot's health")] = None,
    skip_missing: SkipMissing = False,
    jobs: Annotated[
        int | None,
        typer.Option(
            help="processes that make the reports for --store and --report; default: 1",
            min=1,
            max=MOST_JOBS,
            show_default=False,
        ),
    ] = None,
    horizon: Horizon = None,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """Compute a robot's health from its recordings, in the order of their time."""
    ahead = horizon_of(horizon)
    if as_json:
        refuse_unused("JSON, in 1/h", ("store", "report", "jobs", "horizon", "skip_missing"))
    if jobs and not (store or report):
        refuse_unused("a replay that keeps no reports", ("horizon", "unit", "skip_missing"))
    may_write(report, design, *recordings, *files_of(store))
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    sessions = sessions_of(robot, recordings, skip_missing=skip_missing)  # before a store is made for them
    # Without a store the past is kept only for a page that shows it: its reports cost time.
    kept: Store | None = open_store(store) if store else MemoryStore() if report else None
    spans = [(session.first, session.last) for session in sessions]
    with kept or nullcontext(), progress(progress_console(), spans, "replaying") as tick:
        done = [session for session in sessions if kept and kept.progress(robot.identity, session.key).complete]
        if done and len(sessions) == 1:
            warn(f"this recording is already in {store}; it is not counted again")
        elif done:
            warn(f"{len(done)} of {len(sessions)} recordings are already in {store}; they are not counted again")
        health = replace(replay_sessions(robot, sessions, store=kept, jobs=jobs or 1, on_tick=tick), horizon=ahead)
        past = (told_past(kept.history(robot.identity), health), kept.ledger(robot.identity)) if kept and report else ()
    if report:
        write(report, health_page(robot, health, *past))
    if as_json:
        print_json(health.to_json())
    else:
        print_report(health, unit)
        if report:
            console().print(f"Report: {report}", markup=False)
    if health.breaches:
        raise typer.Exit(BREACHED)
