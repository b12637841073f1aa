"""``robophm replay``: a robot's health after what it recorded."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

from robophm.cli.output import console, may_write, print_json, print_report, progress_console, warn, write
from robophm.cli.progress import progress
from robophm.cli.unused import refuse_unused
from robophm.design.file import load
from robophm.monitoring.recorded_drives import drives_of
from robophm.monitoring.replay import replay_drives
from robophm.report.health_page import health_page
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Store


def run(
    design: Path, recordings: Sequence[Path], store: Path | None, report: Path | None, unit: str,
    horizon: float | None, *,
    skip_missing: bool, as_json: bool,
) -> bool:  # fmt: skip
    """Replay, keep, and print or write the report; whether a threshold is breached."""
    if as_json:
        refuse_unused("JSON, in 1/h", ("store", "report", "horizon", "skip_missing"))
    may_write(report, design, *recordings, *([store] if store else []))
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    drives = drives_of(robot, recordings, skip_missing=skip_missing)  # before a store is made for them
    # Without a store the course is kept only for a page that shows it: its reports cost time.
    kept: Store | None = SqliteStore(store) if store else MemoryStore() if report else None
    spans = [(drive.first, drive.last) for drive in drives]
    with kept or nullcontext(), progress(progress_console(), spans, "replaying") as tick:
        done = [drive for drive in drives if kept and kept.progress(robot.name, drive.key).complete]
        if done and len(drives) == 1:
            warn(f"this recording is already in {store}; it is not counted again")
        elif done:
            warn(f"{len(done)} of {len(drives)} recordings are already in {store}; they are not counted again")
        health = replace(replay_drives(robot, drives, store=kept, on_tick=tick), horizon=horizon)
        past = (list(kept.history(robot.name)), kept.ledger(robot.name)) if kept and report else ()
    if report:
        write(report, health_page(robot, health, *past))
    if as_json:
        print_json(health.to_json())
    else:
        print_report(health, unit)
        if report:
            console().print(f"Report: {report}", markup=False)
    return bool(health.breaches)
