"""Stores of a robot's past: its exposure ledger and the history of its reports.

One file here is one store, with one public class derived from ``Store``; the file's name is its name in an address, and
another package adds such a module by an entry point of the group ``robophm.stores``. A store keeps a ledger, the
progress of replays and new reports in one step: after a crash all of it is there, or none.
"""

from __future__ import annotations

import os
from pathlib import Path

from robophm.core.argument_checks import shown
from robophm.core.errors import RobophmError, StoreError, nearest
from robophm.core.registry import has_plug, load_class, plugs
from robophm.core.signal import is_robot_name
from robophm.stores.one_of_several import BETWEEN, one_of_several
from robophm.stores.store import Restored, Store

__all__ = ["Address", "Store", "existing_store", "open_store", "stores"]

NOT_PLUGS = (
    "store", "alarm_log", "events", "figures", "kept_events", "kept_history", "kept_reports", "migration",
    "one_of_several", "outbox", "pyramid", "service_requests", "sqlite_alarms", "trend", "upkeep",
)  # fmt: skip
"""The interface, and what its plugs are built of."""

Address = str | os.PathLike[str]
"""Which store, and where: ``sqlite:robots.db``; a path alone is one in SQLite. Of several robots that share one the
robot's name stands behind it, ``robots.db#amr_2``."""


def stores() -> list[str]:
    """Names of all stores that can be had here, sorted."""
    return plugs(__name__)


def open_store(address: Address) -> Store:
    """The store at this address, which is made where there is none.

    Raises StoreError where it cannot be opened, PlugError where its class cannot be imported.
    """
    kind, where = _kind_and_place(address)
    try:
        store = kind(where)
        robot = _split(address)[2]
        return one_of_several(store, robot) if robot else store
    except RobophmError:
        raise
    except Exception as error:  # whatever a store of another package raises where it is given something else
        reason = " ".join(str(error).split()) or type(error).__name__
        raise StoreError(f"{where}: cannot be opened as a store: {reason}") from error


def existing_store(address: Address) -> Store:
    """A store that is there, opened. Raises StoreError where it is not, or is none."""
    if not store_exists(address):
        raise StoreError(f"{place_of(address)}: no such store")
    return open_store(address)


def store_exists(address: Address) -> bool:
    """Whether there is a store, or what might be one, at this address."""
    kind, where = _kind_and_place(address)
    return kind.exists(where)


def restore_store(address: Address) -> Restored | None:
    """Make a damaged store anew, as far as it can be; None where it is not damaged. Raises StoreError."""
    kind, where = _kind_and_place(address)
    return kind.restore(where) if kind.exists(where) else None


def place_of(address: Address) -> str:
    """The place of a store, such as its path: the address without its kind before it, and a robot behind it."""
    return _split(address)[1]


def _split(address: Address) -> tuple[str, str, str]:
    """The kind of a store, its place, and of several robots in it the one that is meant."""
    if not isinstance(address, str | os.PathLike) or not isinstance(text := os.fspath(address), str) or not text:
        raise StoreError(f"store {shown(address)}: expected a path, or its kind and where it is, sqlite:robots.db")
    text, robot = _robot_in(text)
    name, colon, where = text.partition(":")
    if colon and has_plug(__name__, name):
        return name, where, robot
    if colon and len(name) > 1 and name.isalpha() and not Path(text).exists():  # one letter is a drive of Windows
        raise StoreError(f"store {text:.60}: no kind of store '{name:.60}'{nearest(name, stores())}; "
                         f"a file of that name is ./{text:.60}")  # fmt: skip
    return "sqlite", text, robot


def _robot_in(text: str) -> tuple[str, str]:
    """An address without the name of a robot behind it, and that name; a file that is called so has none."""
    place, between, robot = text.rpartition(BETWEEN)
    return (place, robot) if between and place and is_robot_name(robot) and not Path(text).exists() else (text, "")


def _kind_and_place(address: Address) -> tuple[type[Store], str]:
    name, where, _ = _split(address)
    return load_class(__name__, name, "store", Store), where  # type: ignore[type-abstract]
