"""``robophm watch``: the health of a robot that runs."""

from __future__ import annotations

import signal
import time
from contextlib import ExitStack, nullcontext
from pathlib import Path
from types import FrameType

from rich.live import Live

from robophm.cli.live_table import LiveTable
from robophm.cli.output import console, may_write, print_json, print_report, warn
from robophm.core.signal import split_signal
from robophm.design.file import load
from robophm.drives import lacking
from robophm.monitor import Monitor
from robophm.report.words import rate_text
from robophm.stores.sqlite import SqliteStore
from robophm.transports.journal import Journal
from robophm.transports.ros1 import Ros1
from robophm.watching import watch


def run(
    design: Path, store: Path | None, journal: Path | None, period: float, every: float, unit: str, *, as_json: bool
) -> bool:
    """Listen until SIGINT or SIGTERM; whether a threshold is breached at the end."""
    may_write(journal, design, *([store] if store else []))
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    with ExitStack() as stack:
        source = stack.enter_context(Ros1())
        published = {info.topic: (info.type, info.fields) for info in source.topics()}
        for name, words in lacking(robot, published).items():
            topic, _ = split_signal(name)
            warn(
                words.replace("the recording has no topic", "nobody publishes yet") if topic not in published else words
            )
        kept = stack.enter_context(SqliteStore(store)) if store else None
        written = stack.enter_context(Journal(journal, robot.signals)) if journal else None

        def stop(number: int, frame: FrameType | None) -> None:
            source.close()

        for number in (signal.SIGINT, signal.SIGTERM):
            stack.callback(signal.signal, number, signal.signal(number, stop))
        out, table, said = console(), LiveTable(), time.monotonic()
        with Live(console=out, auto_refresh=False) if out.is_terminal and not as_json else nullcontext() as live:

            def look(monitor: Monitor) -> None:
                nonlocal said
                if live:
                    if table.due():
                        live.update(table.look(monitor, settled=True), refresh=True)
                elif time.monotonic() - said >= every:
                    said = time.monotonic()
                    report = monitor.report(remaining_life=False)
                    if as_json:
                        print_json(report.to_json())
                    else:
                        rate = rate_text(report.system.sensor_based.hazard_rate, unit)
                        out.print(f"{report.clocks['operating']:.3f} h  λ {rate}", markup=False)

            monitor = watch(robot, source, store=kept, journal=written, period=period, on_tick=look)
        health = monitor.report()
        if as_json:
            print_json(health.to_json())
        else:
            print_report(health, unit)
        for what, count in sorted(source.notes.items()):
            warn(f"{what} ({count} times)")
    return bool(health.breaches)
