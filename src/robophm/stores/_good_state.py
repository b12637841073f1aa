"""The last good state of a store, kept in a file beside it, and the store made anew where it is damaged."""

from __future__ import annotations

import json
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from robophm.core.errors import StoreError
from robophm.core.files import sync_folder, write_atomically
from robophm.stores._checked_rows import CheckedTable
from robophm.stores._tables import LEDGER, PROGRESS, SIGNAL, TABLES, keep_signals, make_tables, names_in, signals_of
from robophm.stores.outbox import OUTBOX, make_outbox
from robophm.stores.pyramid import Pyramid
from robophm.stores.store import Restored

KEEP_EVERY = 3600.0
"""Seconds between two good states that are kept of a store that is open."""

Rows = Mapping[str, Sequence[Sequence[Any]]]
"""Keys and values of rows of a robot, by table."""


def good_file(path: Path) -> Path:
    """Return where the good state of a store is kept."""
    return path.with_name(f"{path.name}.good")


def keep_good(path: Path, base: sqlite3.Connection) -> None:
    """Keep ledgers and progress, which are sound, beside the store; what was kept before stays where that fails."""
    with suppress(OSError, sqlite3.Error, StoreError, UnicodeError):
        robots = {robot: _sound(base, robot) for robot in LEDGER.robots(base)}
        text = json.dumps(robots)
        write_atomically(good_file(path), f"{zlib.crc32(text.encode()):08x}\n{text}\n")


def make_anew(path: Path) -> Restored | None:
    """Make a store anew of all that is sound in it, and of the good state beside it; None where all of it is sound.

    The damaged one is kept. Raises StoreError where there is nothing to make it of, or it cannot be written.
    """
    with closing(sqlite3.connect(path, isolation_level=None)) as base:
        if next(faults(base), None) is None:
            return None
        good = _read_good(path)
        robots = {*good, *_robots(base)}
        found: dict[str, Rows] = {}
        said: list[str] = []
        for robot in sorted(robots):
            try:
                found[robot] = _sound(base, robot)
            except (sqlite3.Error, StoreError, ValueError):
                if robot not in good:
                    said.append(f"the past of {robot} is lost: no good state of it was kept")
                    continue
                found[robot] = good[robot]
                said.append(f"the past of {robot} is that of the last good state")
        if not found:
            raise StoreError(f"{path}: damaged, and no good state was kept beside it in {good_file(path).name}")
        copy, new = path.with_name(f"{path.name}.damaged"), path.with_name(f"{path.name}.anew")
        if copy.exists():
            raise StoreError(f"{copy}: exists; expected no such file, to keep the damaged store in")
        new.unlink(missing_ok=True)
        _write(new, found, base)
    for end in ("", "-wal", "-shm"):
        with suppress(FileNotFoundError):
            Path(f"{path}{end}").rename(f"{copy}{end}")
    new.rename(path)
    sync_folder(path.parent)
    return Restored(tuple(said) or ("what is damaged of its history is lost",), copy)


def _write(path: Path, found: Mapping[str, Rows], damaged: sqlite3.Connection) -> None:
    """Make a store of rows that are sound, and of what is sound in the history of a damaged one."""
    with closing(sqlite3.connect(path, isolation_level=None)) as base:
        base.execute("PRAGMA journal_mode = WAL")
        base.execute("BEGIN IMMEDIATE")
        make_tables(base)
        histories = [*TABLES[2:]]
        with suppress(sqlite3.Error, UnicodeError):
            if names_in(damaged).issuperset(table.name for table in OUTBOX):
                make_outbox(base)
                histories += OUTBOX
        for robot, rows in found.items():
            for table in (LEDGER, PROGRESS):
                table.put(base, robot, rows[table.name])
            for table in histories:
                table.put(base, robot, _sound_rows(table, damaged, robot))
            signals = _signals(damaged, robot)
            keep_signals(base, robot, signals)
            for signal in ("", *signals):
                Pyramid(base, signal).take_sound(robot, Pyramid(damaged, signal))
        base.execute("COMMIT")


def faults(base: sqlite3.Connection) -> Iterator[str]:
    """Yield, as a sentence without its point, what is not what was written: of each table and robot the first."""
    with _said() as found:
        (said,) = base.execute("PRAGMA integrity_check(1)").fetchone()
        found += [said.replace("\n", " ")] if said != "ok" else []
    yield from found
    for table in TABLES:
        robots: list[str] = []
        with _said() as found:
            robots = table.robots(base)
        for robot in robots:
            with _said() as more:
                table.check(base, robot)
                for _ in table.rows(base, robot):
                    pass
                if table is LEDGER:
                    for signal in ("", *signals_of(base, robot)):
                        Pyramid(base, signal).check(robot)
            found += more
        yield from found


@contextmanager
def _said() -> Iterator[list[str]]:
    """A list, to which the error that ends the context is added."""
    found: list[str] = []
    try:
        yield found
    except (sqlite3.Error, StoreError, ValueError) as error:
        found.append(str(error))


def good_state_is_damaged(path: Path) -> bool:
    """Whether there is a good state beside a store that is not what was written."""
    return good_file(path).exists() and not _read_good(path)


def _sound(base: sqlite3.Connection, robot: str) -> Rows:
    for table in (LEDGER, PROGRESS):
        table.check(base, robot)
    return {table.name: [*table.rows(base, robot)] for table in (LEDGER, PROGRESS)}


def _robots(base: sqlite3.Connection) -> set[str]:
    """The robots that the store seems to have, as far as it can be read."""
    found: set[str] = set()
    for table in ("content", *(table.name for table in TABLES)):
        with suppress(sqlite3.Error, UnicodeError):
            found.update(name for (name,) in base.execute(f"SELECT DISTINCT robot FROM {table}"))
    return {one for one in found if isinstance(one, str)}


def _sound_rows(table: CheckedTable, base: sqlite3.Connection, robot: str) -> Iterator[tuple[Any, ...]]:
    """The rows that are sound, as far as they can be reached."""
    for key in table.keys(base, robot):
        with suppress(sqlite3.Error, StoreError, UnicodeError):
            if row := table.get(base, robot, *key):
                yield *key, *row


def _signals(base: sqlite3.Connection, robot: str) -> dict[str, int]:
    """The signals of a robot that are sound, as far as they can be reached, and since when each is kept."""
    with suppress(sqlite3.Error, UnicodeError):
        return dict(_sound_rows(SIGNAL, base, robot)) if SIGNAL.name in names_in(base) else {}
    return {}


def _read_good(path: Path) -> dict[str, Rows]:
    try:
        told, _, text = good_file(path).read_text("utf-8").partition("\n")
        text = text.removesuffix("\n")
        if told == f"{zlib.crc32(text.encode()):08x}":
            robots: dict[str, Rows] = json.loads(text)
            return robots
    except (OSError, ValueError):
        pass
    return {}
