"""A fleet's service of one's own, in a thread, and robots' stores with reports in their outboxes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from robophm.fleet.address import FleetAddress
from robophm.fleet.serving import FleetSettings, serve_fleet
from robophm.fleet.store import FleetStore
from robophm.stores.sqlite import SqliteStore

MINUTE = 60 * 10**9
BEGIN = 1_700_000_000 * 10**9
DEADLINE = 60.0
"""Seconds after which a condition that is waited for will not come."""


@dataclass
class Served:
    """A running service."""

    address: str
    path: Path
    fingerprint: str
    port: int

    def of(self, robot: str) -> FleetAddress:
        """Where a robot reports to."""
        return FleetAddress.of(f"{self.address}robots/{robot}")


@contextmanager
def serving(path: Path, **settings: Any) -> Iterator[Served]:
    """A service in a thread, until left."""
    started = threading.Event()
    found: list[Any] = []

    def ready(address: str, fingerprint: str, stop: Any) -> None:
        found.extend((address, fingerprint, stop))
        started.set()

    thread = threading.Thread(target=serve_fleet, args=(FleetSettings(path, **settings), ready), daemon=True)
    thread.start()
    assert started.wait(DEADLINE)
    address, fingerprint, stop = found
    try:
        yield Served(address, path, fingerprint, int(address.rstrip("/").rpartition(":")[2]))
    finally:
        stop()
        thread.join(DEADLINE)
        assert not thread.is_alive()


@pytest.fixture
def fleet(tmp_path: Path) -> Iterator[Served]:
    """A service on a port of its own."""
    with serving(tmp_path / "fleet.db") as served:
        yield served


@pytest.fixture
def store(fleet: Served) -> Iterator[FleetStore]:
    """The store of that service, opened a second time, as the commands do."""
    with FleetStore(fleet.path) as opened:
        yield opened


def report(minute: int, chance: float = 0.01, **more: Any) -> dict[str, Any]:
    """A health report as JSON, as far as a fleet looks into it."""
    view = {
        "hazard_rate": 1e-4, "unreliability": 1e-3 * minute, "remaining_life": {"median": 5000.0 - minute},
        "completion": {"failure": 2e-5},
    }  # fmt: skip
    ahead = [
        {"horizon": hours, "sensor_based_failure": chance * hours / 168, "first": "motor", "share": 0.5, "bound": None}
        for hours in (24.0, 168.0, 720.0)
    ]
    return {
        "robot": "courier", "design_hash": "d1", "time": BEGIN + minute * MINUTE, "clocks": {"operating": minute / 60},
        "subjects": [{"nominal": view, "sensor_based": view}], "state": "ok", "failure_within": ahead, **more,
    }  # fmt: skip


def saved(store: SqliteStore, minutes: range, *, begin: bool = True, each: int = 1, **more: Any) -> None:
    """Reports of some minutes, each save with so many of them and a ledger that grows."""
    if begin:
        store.outboxes.of("courier").begin()
    for first in minutes[::each]:
        some = [report(minute, **more) for minute in minutes if first <= minute < first + each]
        store.save("courier", {"hours": 0.1 * first, "text": "ä"}, reports=some)


def wait_for(condition: Callable[[], Any]) -> Any:
    """What a condition gives once it is true."""
    end = time.monotonic() + DEADLINE
    while not (found := condition()):
        assert time.monotonic() < end, "the condition did not come"
        time.sleep(0.01)
    return found
