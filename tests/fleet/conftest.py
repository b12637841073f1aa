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
from tests.fleet.made_reports import report
from tests.fleet.postgresql_server import Server, missing, running

from robophm.fleet.address import FleetAddress
from robophm.fleet.serving import FleetSettings, serve_fleet
from robophm.fleet.store import FleetStore
from robophm.stores.sqlite import SqliteStore

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


@pytest.fixture(scope="session")
def server() -> Iterator[Server]:
    """A PostgreSQL of these tests, begun where one is asked for."""
    if why := missing():
        pytest.skip(why)
    with running("fsync=off") as begun:
        yield begun


@pytest.fixture(params=["sqlite", "postgresql"])
def address(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The place of a store that is not there yet, in each engine."""
    if request.param == "sqlite":
        return str(tmp_path / "fleet.db")
    found: str = request.getfixturevalue("server").address
    psycopg = pytest.importorskip("psycopg")
    with psycopg.connect(found, autocommit=True) as base:
        base.execute("DROP SCHEMA IF EXISTS robophm_fleet CASCADE")
    return found


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
        time.sleep(0.04)
    return found
