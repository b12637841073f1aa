"""``robophm demo``: a synthetic robot works for a day, is recorded, and its recording becomes its health."""

from __future__ import annotations

import os
import sys
import threading
import time
import webbrowser
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.live import Live

from robophm.cli.shared.health_output import print_report
from robophm.cli.shared.live_table import LiveTable
from robophm.cli.shared.output import console, warn, write
from robophm.core.errors import RobophmError
from robophm.core.signal import split_signal
from robophm.design.file import example_design, load
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.monitoring.told_past import told_past
from robophm.report.curve import sparkline
from robophm.report.health_page import health_page
from robophm.report.words import rate_text
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta

PAGE_SECONDS = 2.0
"""Seconds that the page is served where nobody looks."""

PAGE_SPEED = 20.0
"""Speed of the synthetic robot on the page, in multiples of its own time."""


def command(
    output: Annotated[Path, typer.Option("--to", help="folder for the recording, the store and the report")] = Path(
        "robophm-demo"
    ),
    seed: Annotated[int, typer.Option(help="random seed of the synthetic robot")] = 1,
) -> None:
    """Watch a synthetic robot work for a day."""
    out = console()
    robot = load(example_design())
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RobophmError(f"{output}: cannot be made: {error.strerror}") from None
    recording, past, page = (output / f"robophm-demo{suffix}" for suffix in (".mcap", ".db", ".html"))
    for old in (recording, past, *(past.with_name(past.name + journal) for journal in ("-wal", "-shm"))):
        old.unlink(missing_ok=True)

    begun = time.monotonic()
    robot_day = SyntheticOta(seed=seed)
    robot_day.record(recording)
    hours = robot_day.operating
    took = time.monotonic() - begun
    out.print(
        f"{robot.name} worked through a day: {hours:.1f} h of driving, waiting and charging, made in {took:.1f} s and "
        f"recorded in {recording} ({recording.stat().st_size / 1e6:.1f} MB)", markup=False
    )  # fmt: skip

    table = LiveTable()
    begun = time.monotonic()
    with Recording(recording) as source, SqliteStore(past) as store:
        if out.is_terminal:
            with Live(console=out, auto_refresh=False, transient=True) as live:

                def look(monitor: Monitor) -> None:
                    if table.due():
                        live.update(table.look(monitor), refresh=True)

                report = replay(robot, source, store=store, on_tick=look)
        else:
            report = replay(robot, source, store=store)
        told, ledger = told_past(store.history(robot.identity), report), store.ledger(robot.identity)
        messages = {info.topic: info.messages for info in source.topics()}
        samples = sum(messages[split_signal(signal)[0]] for signal in robot.signals)
    took = time.monotonic() - begun
    out.print(f"Replayed {samples:,} samples in {took:.1f} s, {hours * 3600 / took:,.0f} times as fast as real time.\n")
    print_report(report, "1/h")
    out.print()
    rates = told.series.of("hazard_rate.sensor_based")[1].tolist()
    out.print(
        f"λ sensor-based over the day  {sparkline(rates, 60)}  {rate_text(min(rates))} … {rate_text(max(rates))}",
        markup=False,
    )
    write(page, health_page(robot, report, told, ledger))
    out.print(f"\nReport: {page.resolve()}", markup=False, soft_wrap=True)
    show_page(output / "robophm-demo.yaml", seed)


def show_page(design: Path, seed: int) -> None:
    """Serve the page, the synthetic robot working on it; without a terminal only as long as shows that it answers."""
    out = console()
    try:
        from robophm.web.service import Service, Settings
        from robophm.web.serving import serve
    except ModuleNotFoundError as error:
        warn(f"no page: there is no {error.name}; `pip install 'robophm[web]'` installs it")
        return
    for old in (design, *(design.with_name(design.name + end) for end in (".edits", ".edits-wal", ".edits-shm"))):
        old.unlink(missing_ok=True)
    design.write_bytes(example_design().read_bytes())

    def ready(address: str, service: Service, stop: Callable[[], None]) -> None:
        service.watch("synthetic", PAGE_SPEED)
        until = "until Ctrl+C" if out.is_terminal else f"for {PAGE_SECONDS:.0f} s, as there is no terminal"
        out.print(
            f"Page:   {address} {until}, the robot at {PAGE_SPEED:.0f} times its speed", markup=False, soft_wrap=True
        )
        if out.is_terminal and _has_windows():
            webbrowser.open(address)
        if not out.is_terminal:
            threading.Timer(PAGE_SECONDS, stop).start()

    serve(Settings(design, seed=seed), 0, ready)


def _has_windows() -> bool:
    """Whether a browser would open in a window of its own, and not take this terminal."""
    return sys.platform in ("darwin", "win32") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
