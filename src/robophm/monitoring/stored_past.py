"""A robot's past in a store that is there: to go on from, and with a jump of its clock taken out of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from robophm.core.errors import StoreError
from robophm.design.robot import Robot
from robophm.health.clock_jump_removal import RemovedJump, take_out_jump
from robophm.health.ledger import Ledger
from robophm.monitoring.replay import kept_ledger

if TYPE_CHECKING:
    from robophm.stores.sqlite import SqliteStore


def existing_store(path: Path) -> SqliteStore:
    """Open a store that is there. Raises StoreError where it is not, or is none."""
    from robophm.stores.sqlite import SqliteStore

    if not path.exists():
        raise StoreError(f"{path}: no such store")
    return SqliteStore(path)


def past_in(store: SqliteStore, robot: Robot) -> Ledger:
    """Return the robot's ledger in this store. Raises StoreError where it knows no such robot."""
    ledger = kept_ledger(robot, store)
    if ledger is None:
        raise StoreError(f"{store.path}: knows no robot '{robot.name}'")
    return ledger


class RepairedPast(NamedTuple):
    """The stretch taken out of a robot's past, and the copy of the store as it was before."""

    done: RemovedJump
    copy: Path


def repair_past(store: SqliteStore, robot: Robot) -> RepairedPast | None:
    """Take a jump of the clock by years out of a robot's past in a store, and what came behind it.

    None where no clock jumped: then nothing is changed. Else a copy of the store is made beside it before anything is.
    Raises StoreError where it knows no such robot, or cannot be copied or written.
    """
    ledger = past_in(store, robot)
    done = take_out_jump(robot, ledger)
    if done is None:
        return None
    copy = store.path.with_name(f"{store.path.name}.before-repair")
    store.copy_to(copy)
    store.bring_back(robot.name, ledger.to_json(), done.before)
    return RepairedPast(done, copy)
