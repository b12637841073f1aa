"""``robophm report``: a robot's health on one page that needs nothing else."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from robophm.cli import BREACHED
from robophm.cli.shared.health_output import print_unknown
from robophm.cli.shared.options import Design, Force, Horizon, Store, horizon_of
from robophm.cli.shared.output import console, may_make, warn, write
from robophm.cli.shared.stored_past import files_of, kept
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.told_past import told_past
from robophm.report.health_page import health_page
from robophm.report.pdf import Printer
from robophm.stores import open_store


def command(
    design: Design,
    store: Store = None,
    output: Annotated[
        Path | None, typer.Option("--to", help="page to write; default: health.html, or health.pdf", show_default=False)
    ] = None,
    horizon: Horizon = None,
    pdf: Annotated[bool, typer.Option("--pdf", help="write a PDF; needs robophm[pdf]")] = False,
    short: Annotated[bool, typer.Option("--short", help="without what it follows from: a page or two")] = False,
    force: Force = False,
) -> None:
    """Write a robot's health as one page that needs no other file and no JavaScript."""
    path = output or Path("health.pdf" if pdf else "health.html")
    ahead = horizon_of(horizon)
    suffix = ".pdf" if pdf else ".html"
    may_make(path, design, *files_of(store), force=force, suffixes=(suffix,))
    printer = Printer() if pdf else None  # which may be missing, and says so before the work
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    ledger = kept(store, robot) if store else None
    data = ledger.to_json() if ledger else None
    health = Monitor(robot, ledger).report(horizon=ahead, alarms=True)
    past = None
    if store:
        with open_store(store) as opened:
            past = told_past(opened.history(robot.identity), health)
    html = health_page(robot, health, past, data, short=short)
    write(path, printer.pdf(html) if printer else html)
    print_unknown(health.system.unknown, robot)
    console().print(f"Report: {path}", markup=False, soft_wrap=True)
    if health.breaches:
        raise typer.Exit(BREACHED)
