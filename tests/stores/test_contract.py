"""One suite for every store, and what can go wrong with a file."""

from __future__ import annotations

import json
import os
import sqlite3
import stat
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from robophm.core import registry
from robophm.core.errors import StoreError
from robophm.stores import existing_store, open_store, place_of, store_exists, stores
from robophm.stores._tables import VERSION
from robophm.stores.events import Event
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Progress, Store

STATE = {"sum": [0.1 + 0.2, 5e-324, -0.0, 1.7976931348623157e308], "time": 2**62 + 1, "name": "Ω ‘x’\n", "none": None}
OTHER = {"sum": [1 / 3]}


@pytest.fixture(params=stores())
def address(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    return f"{request.param}:{tmp_path / 'robots'}"


@pytest.fixture
def store(address: str) -> Iterator[Store]:
    with open_store(address) as opened:
        yield opened


def report(time: int, health: float) -> dict[str, Any]:
    return {"time": time, "health": health}


def test_what_is_not_there(store: Store) -> None:
    assert store.ledger("R") is None
    assert store.robots() == []
    assert store.progress("R", "drive") == Progress("drive", 0, False)
    assert list(store.history("R").reports()) == []


def test_what_is_read_is_what_was_saved_bit_for_bit(store: Store) -> None:
    store.save("R", STATE, [Progress("drive", 7, False)], [report(2, 0.1)])
    store.save("S", OTHER)
    assert json.dumps(store.ledger("R")) == json.dumps(STATE)  # −0.0 too
    assert store.ledger("S") == OTHER
    assert store.robots() == ["R", "S"]
    assert store.progress("R", "drive") == Progress("drive", 7, False)
    assert store.progress("S", "drive") == Progress("drive", 0, False)
    assert list(store.history("S").reports()) == []


def test_a_store_keeps_its_own_copy(store: Store) -> None:
    state = {"sum": [1.0]}
    store.save("R", state)
    state["sum"].append(2.0)
    read = store.ledger("R")
    assert read == {"sum": [1.0]}


def test_history_is_in_order_and_a_time_is_told_once(store: Store) -> None:
    late = 2**62
    store.save("R", STATE, (), [report(late - 30, 0.3), report(late, 0.9)])
    store.save("R", STATE, (), [report(late - 40, 0.4), report(late - 30, 0.5)])
    assert list(store.history("R").reports()) == [report(late - 40, 0.4), report(late - 30, 0.5), report(late, 0.9)]


def test_progress_follows_the_last_save(store: Store) -> None:
    store.save("R", STATE, [Progress("drive", 7, False)])
    store.save("R", STATE, [Progress("drive", 12, True, {"receipt time used for /t": 3})])
    store.save("R", STATE)
    assert store.progress("R", "drive") == Progress("drive", 12, True, {"receipt time used for /t": 3})


@pytest.mark.parametrize("place", ["ledger", "report"])
def test_a_save_that_fails_leaves_all_as_it_was(store: Store, place: str) -> None:
    store.save("R", STATE, [Progress("drive", 7, False)], [report(1, 0.1)])
    ledger: dict[str, Any] = {"sum": object()} if place == "ledger" else OTHER
    reports: list[dict[str, Any]] = [report(1, 0.9), {"time": 2, "health": object() if place == "report" else 0.2}]
    with pytest.raises(TypeError):
        store.save("R", ledger, [Progress("drive", 9, True)], reports)
    assert store.ledger("R") == STATE
    assert store.progress("R", "drive") == Progress("drive", 7, False)
    assert list(store.history("R").reports()) == [report(1, 0.1)]
    store.save("R", OTHER)  # and it can go on
    assert store.ledger("R") == OTHER


def test_what_lasts_is_there_when_it_is_opened_again(address: str) -> None:
    assert not store_exists(address)
    with open_store(address) as store:
        store.save("R", STATE, [Progress("drive", 7, False, {"a note": 3})], [report(1, 0.1)])
        store.save("S", OTHER, [Progress("drive", 9, True)])
        store.save("R", OTHER, (), [report(2, 0.2), report(1, 0.3)])
        store.save("R", STATE)
    if not store_exists(address):
        pytest.skip("what it keeps lasts as long as the process")
    with existing_store(address) as store:
        assert json.dumps(store.ledger("R")) == json.dumps(STATE)
        assert store.progress("R", "drive") == Progress("drive", 7, False, {"a note": 3})
        assert list(store.history("R").reports()) == [report(1, 0.3), report(2, 0.2)]
        assert (store.ledger("S"), store.progress("S", "drive")) == (OTHER, Progress("drive", 9, True))


def go_on_together(first: Store, second: Store) -> None:
    assert first.ledger("R") == second.ledger("R") == {"n": 0}
    first.save("R", {"n": 1})
    second.save("R", {"n": 2}, [Progress("drive", 9, True)])


def test_two_who_go_on_with_one_past_do_not_overwrite_each_other(address: str) -> None:
    with open_store(address) as first:
        first.save("R", {"n": 0})
        if not store_exists(address):
            pytest.skip("it is its process's own")
        with ExitStack() as stack, pytest.raises(StoreError):  # where it is opened, or where it saves
            go_on_together(first, stack.enter_context(open_store(address)))
    with existing_store(address) as store:
        assert store.ledger("R") in ({"n": 0}, {"n": 1})
        assert not store.progress("R", "drive").complete


def test_it_is_made_once_by_all_who_open_it_at_the_same_moment(tmp_path: Path) -> None:
    for round_ in range(20):
        together = threading.Barrier(6)

        def begin(path: Path, together: threading.Barrier = together) -> None:
            together.wait()
            open_store(path).close()

        with ThreadPoolExecutor(6) as pool:
            for done in [pool.submit(begin, tmp_path / f"{round_}.db") for _ in range(6)]:
                done.result()


def test_what_is_none_of_its_kind_is_refused_in_one_line(address: str) -> None:
    path = Path(place_of(address))
    path.write_text("name: OTA\n" * 100)
    if not store_exists(address):
        pytest.skip("it reads no file")
    with pytest.raises(StoreError) as raised, open_store(address) as store:
        store.ledger("R")
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)
    assert path.read_text() == "name: OTA\n" * 100


def test_a_path_alone_is_one_in_sqlite(tmp_path: Path) -> None:
    for path in (tmp_path / "robots.db", str(tmp_path / "what:ever")):
        with open_store(path) as store:
            assert isinstance(store, SqliteStore)
            assert store.path == Path(path)


@pytest.mark.parametrize("address", ["", None, 5, b"robots.db"])
def test_what_is_no_address_is_refused(address: Any) -> None:
    with pytest.raises(StoreError, match=r"expected a path, or its kind and where it is, sqlite:robots\.db"):
        open_store(address)


def test_a_kind_of_store_that_is_misspelt_makes_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StoreError, match=r"no kind of store 'sqlte'; did you mean 'sqlite'"):
        open_store("sqlte:past.db")
    assert not list(tmp_path.iterdir())
    with open_store("./sqlte:past.db"):
        assert [one.name for one in tmp_path.iterdir() if ":" in one.name]


def test_a_store_that_is_not_there(tmp_path: Path) -> None:
    for address in (tmp_path / "robots.db", f"sqlite:{tmp_path / 'robots.db'}", "memory:"):
        with pytest.raises(StoreError, match=r"no such store$"):
            existing_store(address)
    assert not (tmp_path / "robots.db").exists()


def test_a_store_of_another_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "their_store.py").write_text(
        "from robophm.stores.memory import MemoryStore\n\n\nclass TheirStore(MemoryStore):\n    pass\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "their_store", raising=False)
    entry = EntryPoint("theirs", "their_store", "robophm.stores")
    monkeypatch.setattr(registry, "entry_points", lambda *, group, name=None: [entry] if group == entry.group else [])
    assert stores() == ["memory", "sqlite", "theirs"]
    assert type(open_store("theirs:anything")).__name__ == "TheirStore"


# A file of SQLite can be many things that are not a store.


def test_a_reader_beside_the_writer_sees_all_of_a_save_or_nothing(tmp_path: Path) -> None:
    with SqliteStore(tmp_path / "robots.db") as writer, SqliteStore(tmp_path / "robots.db") as reader:
        writer.save("R", STATE)
        with pytest.raises(StoreError):  # the last of its rows cannot be kept
            writer.save("R", OTHER, [Progress("drive", 7, True)], [report(1, 0.1)], [Event(1, "alarm", None, "")])  # type: ignore[arg-type]
        assert (reader.ledger("R"), list(reader.history("R").reports())) == (STATE, [])
        assert reader.progress("R", "drive").position == 0


def test_the_first_save_of_another_while_names_are_asked_for_is_no_damage(tmp_path: Path) -> None:
    with SqliteStore(tmp_path / "robots.db") as writer, SqliteStore(tmp_path / "robots.db") as reader:

        def saves(statement: str) -> None:  # between the two questions of which the answers are compared
            if "FROM content" in statement and not writer.robots():
                writer.save("R", STATE)

        reader._base.set_trace_callback(saves)
        assert reader.robots() == []
        reader._base.set_trace_callback(None)
        assert reader.robots() == ["R"]


def other_tables(path: Path) -> None:
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("CREATE TABLE music (title)")
    base.close()


def later_version(path: Path) -> None:
    SqliteStore(path).close()
    with closing(sqlite3.connect(path)) as base, base:
        base.execute(f"PRAGMA user_version = {VERSION + 1}")
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
    "other tables": (other_tables, "not a robophm store of version 4 .its version is 0"),
    "later version": (later_version, "of version 5, of a newer robophm; this one knows up to version 4"),
    "torn": (torn_state, "the ledger of R is damaged: its checksum is another; robophm store repair goes back"),
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
from robophm.stores.events import Event
from robophm.stores._tables import VERSION
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
            store.save("R", {"round": i, "much": "x" * 20_000}, (), [{"time": i, "much": "x" * 20_000}])
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
        assert [one["time"] for one in store.history("R").reports()] == [int(i) for i in saved]


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


ALONE = """
import sys, time
from robophm.stores import open_store
with open_store(sys.argv[1]) as store, store.alone("R"):
    print("there", flush=True)
    time.sleep(600)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs locks of files")
def test_one_process_at_a_time_goes_on_with_a_past_and_a_killed_one_leaves_no_lock(tmp_path: Path) -> None:
    path = tmp_path / "robots.db"
    other = subprocess.Popen([sys.executable, "-c", ALONE, str(path)], stdout=subprocess.PIPE, text=True)
    try:
        assert other.stdout
        assert other.stdout.readline() == "there\n"
        with SqliteStore(path) as store:
            with pytest.raises(StoreError, match=f"process {other.pid} goes on with the past of R"), store.alone("R"):
                pass
            with store.alone("S"):
                assert len(list(tmp_path.glob("*.lock"))) == 2
            other.kill()
            other.wait()
            with store.alone("R"):
                pass
    finally:
        other.kill()
        other.communicate()
    assert list(tmp_path.glob("*.lock")) == []
