"""Arguments of this room's functions: a robot or the path of its design, and its past from a store."""

from __future__ import annotations

import os
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

from robophm.core.argument_checks import path, shown
from robophm.core.errors import DesignError, PlugError, RobophmError
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.monitoring.stored_past import stored_past
from robophm.stores import Address

RobotOrPath = Robot | str | os.PathLike[str]
Paths = str | os.PathLike[str] | Iterable[str | os.PathLike[str]]


def robot_of(given: RobotOrPath) -> Robot:
    """The robot, or that of a design file. Raises DesignError."""
    return given if isinstance(given, Robot) else load(path(given, "robot", DesignError))


def ledger_of(store: Address | None, robot: Robot) -> Ledger | None:
    """The robot's past in a store; None where none is named. Raises StoreError where it knows no such robot."""
    if store is None:
        return None
    with stored_past(store, robot) as (_, ledger):
        return ledger


def paths_of(given: Paths, what: str) -> list[Path]:
    """One path or several. Raises RobophmError where there is none."""
    if isinstance(given, str | os.PathLike):
        return [path(given, what, RobophmError)]
    if isinstance(given, dict | bytes) or not isinstance(given, Iterable):
        raise RobophmError(f"{what} {shown(given)}: expected a path, or a list of paths")
    if not (found := [path(one, what, RobophmError) for one in given]):
        raise RobophmError(f"{what} {shown(given)}: expected at least one path")
    return found


def of_extra(module: str, what: str) -> Any:
    """A module of the extra ``notebook``. Raises PlugError, with how to get it, where it is not installed."""
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise PlugError(
            f"{what} needs {package}, which is not installed ({error}): pip install robophm[notebook]"
        ) from None
