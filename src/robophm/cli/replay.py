"""``robophm replay``: a robot's health after what it recorded."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

from robophm.cli.output import console, may_write, print_json, print_report, progress_console, warn, write
from robophm.cli.progress import progress
from robophm.design.file import load
from robophm.replaying import available, recording_key
from robophm.replaying import replay as replay_recording
from robophm.report.health_page import health_page
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Store
from robophm.transports.source import open_source


def run(
    design: Path, recordings: Sequence[Path], store: Path | None, report: Path | None, unit: str, *,
    skip_missing: bool, as_json: bool,
) -> bool:  # fmt: skip
    """Replay, keep, and print or write the report; whether a threshold is breached."""
    may_write(report, design, *recordings, *([store] if store else []))
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    with open_source(*recordings) as source:
        signals = available(robot, source, skip_missing=skip_missing)  # before a store is made for it
        # Without a store the course is kept only for a page that shows it: its reports cost time.
        kept: Store | None = SqliteStore(store) if store else MemoryStore() if report else None
        with kept or nullcontext(), progress(progress_console(), source, "replaying") as tick:
            if kept and kept.progress(robot.name, recording_key(source, signals)).complete:
                warn(f"this recording is already in {store}; it is not counted again")
            health = replay_recording(robot, source, store=kept, skip_missing=skip_missing, on_tick=tick)
            history = list(kept.history(robot.name)) if kept and report else []
    if report:
        write(report, health_page(robot, health, history))
    if as_json:
        print_json(health.to_json())
    else:
        print_report(health, unit)
        if report:
            console().print(f"Report: {report}", markup=False)
    return bool(health.breaches)
