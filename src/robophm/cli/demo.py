"""The demonstration: a synthetic robot works for a day, is recorded, and its recording becomes its health."""

from __future__ import annotations

import time
from pathlib import Path

from rich.live import Live

from robophm.cli.live_table import LiveTable
from robophm.cli.output import console, print_report, write
from robophm.core.errors import RobophmError
from robophm.core.files import shipped
from robophm.core.signal import split_signal
from robophm.design.file import load
from robophm.monitor import Monitor
from robophm.replaying import replay
from robophm.report.curve import sparkline
from robophm.report.health_page import health_page
from robophm.report.words import rate_text
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recording import Recording
from robophm.transports.synthetic import SyntheticOta

"""Seconds between two looks at the live table."""


def example_design() -> Path:
    """The OTA's design. Raises RobophmError where it is not installed."""
    return shipped("examples/ota/robot.yaml")


def run(output: Path, seed: int) -> None:
    """Drive, record, replay, report; all files go into ``output``, which is made."""
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
    hours = len(robot_day.times) / 3600  # one look a second while it is on
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
        history = list(store.history(robot.name))
        messages = {info.topic: info.messages for info in source.topics()}
        samples = sum(messages[split_signal(signal)[0]] for signal in robot.signals)
    took = time.monotonic() - begun
    out.print(
        f"Replayed {samples:,} samples in {took:.1f} s, {hours * 3600 / took:,.0f} times as fast as they were lived.\n"
    )
    print_report(report, "1/h")
    out.print()
    rates = [entry["subjects"][0]["sensor_based"]["hazard_rate"] for entry in history]
    out.print(
        f"λ sensor-based over the day  {sparkline(rates, 60)}  {rate_text(min(rates))} … {rate_text(max(rates))}",
        markup=False,
    )
    write(page, health_page(robot, report, history))
    out.print(f"\nReport: {page.resolve()}", markup=False, soft_wrap=True)
