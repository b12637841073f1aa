"""A watch in this process of what a node says of itself, and what becomes of it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robophm.design.robot import Robot
from robophm.monitoring.live_loop import watch
from robophm.monitoring.monitor import Monitor
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.journal import Journal
from robophm.transports.signals.source import LiveSource


@contextmanager
def watched(robot: Robot, source: LiveSource, folder: Path) -> Iterator[list[Monitor]]:
    """Watch into ``past.db`` and ``run.journal`` of a folder until the block ends; gives the monitor once it lives."""
    begun: list[Monitor] = []
    failed: list[BaseException] = []

    def run() -> None:
        try:
            with SqliteStore(folder / "past.db") as store, Journal(folder / "run.journal", robot.signals) as journal:
                watch(robot, source, store=store, journal=journal, period=0.2, on_start=begun.append)
        except BaseException as error:
            failed.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield begun
    finally:
        source.stop()
        thread.join(20)
    assert not failed, failed


def services(begun: list[Monitor]) -> list[tuple[str, str]]:
    """What the watched ledger knows of failures: the kind, and who said so."""
    return [(one.kind, one.by) for monitor in begun for one in monitor.ledger.services]
