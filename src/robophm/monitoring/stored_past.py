"""A robot's past in a store that is there: to go on from, and with a jump of its clock taken out of it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import NamedTuple

from robophm.core.errors import StoreError, nearest
from robophm.design.identities import identities
from robophm.design.robot import Robot
from robophm.health.clock_jump_removal import RemovedJump, take_out_jump
from robophm.health.ledger import Ledger, SuspectTime
from robophm.health.ledger_parts import Fate, fates, identity_of
from robophm.health.suspect_time import Verdict, open_stretch, settle
from robophm.monitoring.replay import kept_ledger
from robophm.stores import Address, existing_store, place_of
from robophm.stores.one_of_several import BETWEEN
from robophm.stores.store import Store


@contextmanager
def stored_past(address: Address, robot: Robot, *, change: bool = False) -> Iterator[tuple[Store, Ledger]]:
    """A store that is there, and the robot's ledger in it, to ``change`` it or to look at it.

    Raises StoreError where it knows no such robot, and where somebody else goes on with what is to be changed.
    """
    with existing_store(address) as store, store.alone(robot.identity) if change else nullcontext():
        ledger = kept_ledger(robot, store)
        if ledger is None:
            raise unknown_robot(address, store, robot)
        yield store, ledger


@contextmanager
def stored_history(address: Address, robot: Robot) -> Iterator[Store]:
    """A store that is there and knows the robot, to look at its history. Raises StoreError where it does not."""
    with existing_store(address) as store:
        if store.history(robot.identity).report_at(0) is None and robot.identity not in store.robots():
            raise unknown_robot(address, store, robot)
        yield store


def unknown_robot(address: Address, store: Store, robot: Robot) -> StoreError:
    """Return what is to be said where a store has no past of a robot."""
    if not (known := store.robots()):
        return StoreError(
            f"{place_of(address)}: holds no robot's past yet; expected one that replay, watch or serve made"
        )
    if several := [name for name in known if name.startswith(f"{robot.identity}{BETWEEN}")]:
        which = f"{place_of(address)}{BETWEEN}{several[0].rpartition(BETWEEN)[2]}"
        return StoreError(
            f"{place_of(address)}: holds the pasts of {len(several)} robots '{robot.identity}'; expected which, {which}"
        )
    said = f"{place_of(address)}: knows no robot '{robot.identity}'{nearest(robot.identity, known)}"
    other = f"; where it is '{known[0]}' under another name, `identity: {known[0]}` in its design says so"
    return StoreError(f"{said}{other}")


def fates_in(address: Address, robot: Robot) -> list[Fate]:
    """Return what becomes of the past of each part of a robot in a store. Raises StoreError where it has none."""
    with existing_store(address) as store:
        data = store.ledger(robot.identity)
        if data is None:
            raise unknown_robot(address, store, robot)
        return fates(data, identities(robot))


def identity_in(address: Address, robot: Robot, name: str) -> str:
    """Return the identity of what had this path in a robot's past, or of a robot. Raises StoreError for an unknown."""
    with existing_store(address) as store:
        if name in (robots := store.robots()):
            return name
        data = store.ledger(robot.identity)
        if data is None:
            raise unknown_robot(address, store, robot)
        if (found := identity_of(data, name)) is not None:
            return found
        known = [path for path, _ in data.get("parts", {}).values()]
        raise StoreError(f"{place_of(address)}: there is no '{name}' in the past{nearest(name, [*known, *robots])}")


class RepairedPast(NamedTuple):
    """The stretch taken out of a robot's past, and the copy of the store as it was before."""

    done: RemovedJump
    copy: Path


def repair_past(address: Address, robot: Robot) -> RepairedPast | None:
    """Take a jump of the clock by years out of a robot's past in a store, and what came behind it.

    None where no clock jumped: then nothing is changed. Else a copy of the store is made beside it before anything is.
    Raises StoreError where it knows no such robot, or cannot be copied or written.
    """
    with stored_past(address, robot, change=True) as (store, ledger):
        done = take_out_jump(robot, ledger)
        if done is None:
            return None
        copy = _copied(store, address)
        store.bring_back(robot.identity, ledger.to_json(), done.before)
        return RepairedPast(done, copy)


class SettledPast(NamedTuple):
    """The stretch of a robot's past that was taken in or struck out, and the copy of the store as it was before."""

    done: SuspectTime
    copy: Path


def settle_past(address: Address, robot: Robot, verdict: Verdict) -> SettledPast:
    """Take in or strike out what the clock is off by without which a robot's time went on, as ``settle``.

    A copy of the store is made beside it before anything is changed. Raises RobophmError as ``settle``, StoreError
    where the store knows no such robot, or cannot be copied or written.
    """
    with stored_past(address, robot, change=True) as (store, ledger):
        done = settle(robot, ledger, verdict)
        copy = _copied(store, address)
        if done.ahead < 0 and ledger.integrated_to is not None:
            store.bring_back(robot.identity, ledger.to_json(), ledger.integrated_to)
        else:
            store.save(robot.identity, ledger.to_json())
        return SettledPast(done, copy)


def suspect_time_in(address: Address, robot: Robot) -> SuspectTime | None:
    """Return the stretch that lasts until now in which the clock was not plausible. Raises StoreError as the others."""
    with stored_past(address, robot) as (_, ledger):
        return open_stretch(ledger)


def _copied(store: Store, address: Address) -> Path:
    copy = Path(f"{place_of(address)}.before-repair")
    store.upkeep().copy_to(copy)
    return copy
