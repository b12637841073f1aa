"""The health of a robot and its future: ``robophm.predict``."""

from __future__ import annotations

from typing import Unpack

from robophm.health.report import HealthReport
from robophm.interface.asking import RobotOrPath, ledger_of, robot_of
from robophm.monitoring.monitor import Monitor, ReportOptions
from robophm.stores import Address


def predict(robot: RobotOrPath, store: Address | None = None, **options: Unpack[ReportOptions]) -> HealthReport:
    """A robot's health with what lies ahead of it: as new and designed, or by its past in a store.

    Options are those of ``Monitor.report``: task, plan, future, knowledge, draws, parts, horizon.
    Raises DesignError, StoreError, or RobophmError for options that cannot be.
    """
    found = robot_of(robot)
    return Monitor(found, ledger_of(store, found)).report(**options)
