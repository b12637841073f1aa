"""What commands about a robot with a past share: its ledger from a store, and how many draws can be paid for."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from robophm.cli.shared.output import warn
from robophm.core.errors import RobophmError, StoreError
from robophm.design.robot import Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.subject import silence
from robophm.monitoring.replay import kept_ledger

if TYPE_CHECKING:
    from robophm.stores.sqlite import SqliteStore

MOST_DRAWN = 30_000_000
"""Rates that are drawn in all: ten arrays of so many numbers are 2.4 GB."""


def affordable(draws: int, robot: Robot) -> None:
    """Raises RobophmError where so many draws of the robot's rates would be too many."""
    most = MOST_DRAWN // max(sum(mode.uncertainty is not None for mode in robot.modes), 1)
    if draws > most:
        raise RobophmError(f"--draws {draws}: too many for so many uncertain rates; expected at most {most}")


def kept(path: Path, robot: Robot) -> Ledger:
    """A robot's past from its store. Raises StoreError where there is none."""
    with existing_store(path) as store:
        ledger = past_in(store, robot)
    exposure = ExposureIntegrator(robot)
    if words := silence(exposure.silent(exposure.settled(ledger))):
        warn(f"the past of {robot.name} {words}")
    return ledger


def existing_store(path: Path) -> SqliteStore:
    """A store that is there. Raises StoreError where it is not, or is none."""
    from robophm.stores.sqlite import SqliteStore

    if not path.exists():
        raise StoreError(f"{path}: no such store; `robophm replay --store` makes it")
    return SqliteStore(path)


def past_in(store: SqliteStore, robot: Robot) -> Ledger:
    """The robot's past in this store. Raises StoreError where it knows no such robot."""
    ledger = kept_ledger(robot, store)
    if ledger is None:
        raise StoreError(f"{store.path}: knows no robot '{robot.name}'")
    return ledger
