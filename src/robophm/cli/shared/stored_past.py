"""The past of a robot, for commands that need it: its ledger from a store, and the draws that can be paid for."""

from __future__ import annotations

from pathlib import Path

from robophm.cli.shared.output import warn
from robophm.design.robot import Robot
from robophm.health.draws import check_draws as draws_of
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.prognosis import Outlook
from robophm.health.subject import silence
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.stored_past import stored_past
from robophm.stores import Address, place_of


def check_draws(draws: int, robot: Robot) -> None:
    """Raise RobophmError where so many draws of the robot's rates would be too many."""
    draws_of(draws, robot, "--draws")


def files_of(store: Address | None) -> list[Path]:
    """The file that a store is, so that nothing else takes its place."""
    return [] if store is None else [Path(place_of(store))]


def kept(address: Address, robot: Robot) -> Ledger:
    """A robot's past from its store. Raises StoreError where there is none."""
    with stored_past(address, robot) as (_, ledger):
        pass
    exposure = ExposureIntegrator(robot)
    if words := silence(exposure.silent(exposure.settled(ledger))):
        warn(f"the past of {robot.name} {words}")
    return ledger


def outlook_of(address: Address, robot: Robot) -> Outlook:
    """How a robot stands now by its past in a store. Raises StoreError where there is none."""
    return Monitor(robot, kept(address, robot)).report(remaining_life=False).outlooks["sensor_based"]
