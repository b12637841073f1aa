"""One suite for every store, and what can go wrong with a file."""

from __future__ import annotations

import json
import os
import sqlite3
import stat
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import StoreError
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Progress, Store

STATE = {"sum": [0.1 + 0.2, 5e-324, -0.0, 1.7976931348623157e308], "time": 2**62 + 1, "name": "Ω ‘x’\n", "none": None}
OTHER = {"sum": [1 / 3]}


@pytest.fixture(params=["memory", "sqlite"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    with MemoryStore() if request.param == "memory" else SqliteStore(tmp_path / "robots.db") as opened:
        yield opened


def report(time: int, health: float) -> dict[str, Any]:
    return {"time": time, "health": health}


def test_what_is_not_there(store: Store) -> None:
    assert store.ledger("R") is None
    assert store.progress("R", "drive") == Progress("drive", 0, False)
    assert list(store.history("R")) == []


def test_what_is_read_is_what_was_saved_bit_for_bit(store: Store) -> None:
    store.save("R", STATE, Progress("drive", 7, False), [report(2, 0.1)])
    store.save("S", OTHER)
    assert json.dumps(store.ledger("R")) == json.dumps(STATE)  # −0.0 too
    assert store.ledger("S") == OTHER
    assert store.progress("R", "drive") == Progress("drive", 7, False)
    assert store.progress("S", "drive") == Progress("drive", 0, False)
    assert list(store.history("S")) == []


def test_a_store_keeps_its_own_copy(store: Store) -> None:
    state = {"sum": [1.0]}
    store.save("R", state)
    state["sum"].append(2.0)
    read = store.ledger("R")
    assert read == {"sum": [1.0]}


def test_history_is_in_order_and_a_time_is_told_once(store: Store) -> None:
    store.save("R", STATE, None, [report(30, 0.3), report(2**62, 0.9)])
    store.save("R", STATE, None, [report(4, 0.4), report(30, 0.5)])
    assert list(store.history("R")) == [report(4, 0.4), report(30, 0.5), report(2**62, 0.9)]


def test_progress_follows_the_last_save(store: Store) -> None:
    store.save("R", STATE, Progress("drive", 7, False))
    store.save("R", STATE, Progress("drive", 12, True, {"receipt time used for /t": 3}))
    store.save("R", STATE)
    assert store.progress("R", "drive") == Progress("drive", 12, True, {"receipt time used for /t": 3})


@pytest.mark.parametrize("place", ["ledger", "report"])
def test_a_save_that_fails_leaves_all_as_it_was(store: Store, place: str) -> None:
    store.save("R", STATE, Progress("drive", 7, False), [report(1, 0.1)])
    ledger: dict[str, Any] = {"sum": object()} if place == "ledger" else OTHER
    reports: list[dict[str, Any]] = [report(1, 0.9), {"time": 2, "health": object() if place == "report" else 0.2}]
    with pytest.raises(TypeError):
        store.save("R", ledger, Progress("drive", 9, True), reports)
    assert store.ledger("R") == STATE
    assert store.progress("R", "drive") == Progress("drive", 7, False)
    assert list(store.history("R")) == [report(1, 0.1)]
    store.save("R", OTHER)  # and it can go on
    assert store.ledger("R") == OTHER


# A file lasts, and can be many things that are not a store.


def test_a_file_is_there_when_it_is_opened_again(tmp_path: Path) -> None:
    with SqliteStore(tmp_path / "robots.db") as store:
        store.save("R", STATE, Progress("drive", 7, True), [report(1, 0.1)])
    with SqliteStore(tmp_path / "robots.db") as store:
        assert json.dumps(store.ledger("R")) == json.dumps(STATE)
        assert store.progress("R", "drive") == Progress("drive", 7, True)
        assert list(store.history("R")) == [report(1, 0.1)]


def test_a_reader_beside_the_writer_sees_all_of_a_save_or_nothing(tmp_path: Path) -> None:
    with SqliteStore(tmp_path / "robots.db") as writer, SqliteStore(tmp_path / "robots.db") as reader:
        writer.save("R", STATE)
        with pytest.raises(StoreError):  # the last of its rows cannot be kept
            writer.save("R", OTHER, Progress("drive", 7, True), [report(1, 0.1), {"time": None}])
        assert (reader.ledger("R"), list(reader.history("R"))) == (STATE, [])
        assert reader.progress("R", "drive").position == 0


def other_tables(path: Path) -> None:
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("CREATE TABLE music (title)")
    base.close()


def later_version(path: Path) -> None:
    SqliteStore(path).close()
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("PRAGMA user_version = 3")
    base.close()


def torn_state(path: Path) -> None:
    with SqliteStore(path) as store:
        store.save("R", STATE)
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("""UPDATE ledger SET state = '{"sum": [0.1'""")
    base.close()


NOT_STORES: dict[str, tuple[Callable[[Path], object], str]] = {
    "text": (lambda path: path.write_text("name: OTA\n" * 100), "not a database"),
    "folder": (lambda path: path.mkdir(), "unable to open"),
    "other tables": (other_tables, "not a robophm store of version 2 .its version is 0"),
    "later version": (later_version, "not a robophm store of version 2 .its version is 3"),
    "torn": (torn_state, "expected a robophm store that can be read"),
    "no folder": (lambda _: None, "unable to open"),
}


@pytest.mark.parametrize(("make", "says"), NOT_STORES.values(), ids=NOT_STORES)
def test_what_is_no_store_is_refused_in_one_line(
    make: Callable[[Path], object], says: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    path = tmp_path / ("nowhere/robots.db" if "no folder" in request.node.name else "robots.db")
    make(path)
    with pytest.raises(StoreError, match=says) as raised, SqliteStore(path) as store:
        store.ledger("R")
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)


SAVING = """
import json, os, resource, signal, sys
from robophm.core.errors import StoreError
from robophm.stores.sqlite import SqliteStore
path, limit, user = sys.argv[1], *map(int, sys.argv[2:])
if user:
    os.setuid(user)
if limit:  # as on a full disk: no file can grow beyond this
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
try:
    with SqliteStore(path) as store:
        for i in range(100):
            store.save("R", {"round": i, "much": "x" * 20_000}, None, [{"time": i, "much": "x" * 20_000}])
            print(i, flush=True)
except StoreError as error:
    sys.exit(f"StoreError: {error}")
"""


def saving(path: Path, *, limit: int = 0, user: int = 0) -> tuple[list[str], str]:
    """What another process could save, and how it ended."""
    command = [sys.executable, "-c", SAVING, str(path), str(limit), str(user)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    return done.stdout.split(), done.stderr.strip()


@pytest.mark.skipif(sys.platform == "win32", reason="needs limits of file size")
def test_a_full_disk_is_an_error_and_loses_nothing(tmp_path: Path) -> None:
    path = tmp_path / "robots.db"
    saved, error = saving(path, limit=400_000)
    assert error.startswith(f"StoreError: {path}: ")
    assert "\n" not in error
    assert 1 < len(saved) < 100
    with SqliteStore(path) as store:
        ledger = store.ledger("R")
        assert ledger
        assert ledger["round"] == int(saved[-1])
        assert [one["time"] for one in store.history("R")] == [int(i) for i in saved]


@pytest.mark.skipif(sys.platform == "win32", reason="needs users and permissions")
def test_a_file_that_may_not_be_written_is_an_error() -> None:
    with tempfile.TemporaryDirectory() as folder:  # nobody may not enter pytest's own
        path = Path(folder) / "robots.db"
        with SqliteStore(path) as store:
            store.save("R", STATE)
        path.chmod(stat.S_IRUSR | stat.S_IRGRP | stat.S_IROTH)
        Path(folder).chmod(0o555)
        saved, error = saving(path, user=0 if os.geteuid() else 65534)  # root may write everywhere
        Path(folder).chmod(0o755)
        assert (saved, "\n" in error) == ([], False)
        assert error.startswith(f"StoreError: {path}: ")
        with SqliteStore(path) as store:
            assert store.ledger("R") == STATE


def test_two_who_go_on_with_one_ledger_do_not_overwrite_each_other(tmp_path: Path) -> None:
    with SqliteStore(tmp_path / "two.db") as first, SqliteStore(tmp_path / "two.db") as second:
        first.save("R", {"version": 1, "n": 0})
        assert first.ledger("R") == second.ledger("R")
        second.save("R", {"version": 1, "n": 2})
        with pytest.raises(StoreError, match="another process has gone on with R"):
            first.save("R", {"version": 1, "n": 1}, Progress("drive", 9, True))
        assert second.ledger("R") == {"version": 1, "n": 2}
        assert not second.progress("R", "drive").complete
        second.save("R", {"version": 1, "n": 3})
