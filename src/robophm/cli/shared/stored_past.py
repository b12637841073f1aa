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
from robophm.monitoring.stored_past import existing_store, past_in


def check_draws(draws: int, robot: Robot) -> None:
    """Raise RobophmError where so many draws of the robot's rates would be too many."""
    draws_of(draws, robot, "--draws")


def kept(path: Path, robot: Robot) -> Ledger:
    """Return a robot's past from its store. Raises StoreError where there is none."""
    with existing_store(path) as store:
        ledger = past_in(store, robot)
    exposure = ExposureIntegrator(robot)
    if words := silence(exposure.silent(exposure.settled(ledger))):
        warn(f"the past of {robot.name} {words}")
    return ledger


def outlook_of(path: Path, robot: Robot) -> Outlook:
    """Return the outlook of a robot by its past in a store. Raises StoreError where there is none."""
    return Monitor(robot, kept(path, robot)).report(remaining_life=False).outlooks["sensor_based"]
