"""``robophm report``: a robot's health on one page that needs nothing else."""

from __future__ import annotations

from pathlib import Path

from robophm.cli.output import console, may_make, print_unknown, warn, write
from robophm.cli.past import kept
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor
from robophm.report.health_page import health_page
from robophm.report.pdf import Printer


def run(design: Path, store: Path | None, output: Path, horizon: float | None, *, pdf: bool, force: bool) -> bool:
    """Write the page; whether a threshold is breached. The same design and past give the same bytes."""
    suffix = ".pdf" if pdf else ".html"
    may_make(output, design, *([store] if store else []), force=force, suffixes=(suffix,))
    printer = Printer() if pdf else None  # which may be missing, and says so before the work
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    ledger = kept(store, robot) if store else None
    history = []
    if store:
        from robophm.stores.sqlite import SqliteStore

        with SqliteStore(store) as past:
            history = list(past.history(robot.name))
    data = ledger.to_json() if ledger else None
    health = Monitor(robot, ledger).report(horizon=horizon)
    html = health_page(robot, health, history, data)
    write(output, printer.pdf(html) if printer else html)
    print_unknown(health.system.unknown, robot)
    console().print(f"Report: {output}", markup=False, soft_wrap=True)
    return bool(health.breaches)
