"""``robophm report``: a robot's health on one page that needs nothing else."""

from __future__ import annotations

from pathlib import Path

from robophm.cli.output import console, may_make, warn, write
from robophm.cli.past import kept
from robophm.design.file import load
from robophm.monitor import Monitor
from robophm.report.health_page import health_page


def run(design: Path, store: Path | None, output: Path, *, force: bool) -> bool:
    """Write the page; whether a threshold is breached. The same design and past give the same bytes."""
    may_make(output, design, *([store] if store else []), force=force, suffixes=(".html",))
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    ledger = kept(store, robot) if store else None
    history = []
    if store:
        from robophm.stores.sqlite import SqliteStore

        with SqliteStore(store) as past:
            history = list(past.history(robot.name))
    health = Monitor(robot, ledger).report()
    write(output, health_page(robot, health, history))
    console().print(f"Report: {output}", markup=False, soft_wrap=True)
    return bool(health.breaches)
