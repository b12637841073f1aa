"""A robot's past in a store that is there: to go on from, and with a jump of its clock taken out of it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from robophm.core.errors import StoreError
from robophm.design.robot import Robot
from robophm.health.clock_jump_removal import RemovedJump, take_out_jump
from robophm.health.ledger import Ledger
from robophm.monitoring.replay import kept_ledger
from robophm.stores import Address, existing_store, place_of
from robophm.stores.store import Store


@contextmanager
def stored_past(address: Address, robot: Robot) -> Iterator[tuple[Store, Ledger]]:
    """A store that is there, and the robot's ledger in it. Raises StoreError where it knows no such robot."""
    with existing_store(address) as store:
        ledger = kept_ledger(robot, store)
        if ledger is None:
            raise StoreError(f"{place_of(address)}: knows no robot '{robot.name}'")
        yield store, ledger


class RepairedPast(NamedTuple):
    """The stretch taken out of a robot's past, and the copy of the store as it was before."""

    done: RemovedJump
    copy: Path


def repair_past(address: Address, robot: Robot) -> RepairedPast | None:
    """Take a jump of the clock by years out of a robot's past in a store, and what came behind it.

    None where no clock jumped: then nothing is changed. Else a copy of the store is made beside it before anything is.
    Raises StoreError where it knows no such robot, or cannot be copied or written.
    """
    with stored_past(address, robot) as (store, ledger):
        done = take_out_jump(robot, ledger)
        if done is None:
            return None
        copy = Path(f"{place_of(address)}.before-repair")
        store.copy_to(copy)
        store.bring_back(robot.name, ledger.to_json(), done.before)
        return RepairedPast(done, copy)
