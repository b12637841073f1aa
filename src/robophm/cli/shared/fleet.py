"""Options of commands about a fleet, and the sending of a robot's reports to one."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from robophm.cli.shared.output import warn
from robophm.core.errors import DataError, RobophmError, nearest

if TYPE_CHECKING:
    from robophm.fleet.address import FleetAddress
    from robophm.fleet.sender import Sender

TOKEN = "ROBOPHM_FLEET_TOKEN"
"""The variable of the environment that holds a robot's token."""

FleetStorePath = Annotated[
    str, typer.Option("--store", help="the fleet's store: a SQLite file, or postgresql://host/database")
]
Designs = Annotated[list[Path], typer.Argument(help="design files of the robots", metavar="ROBOT.YAML…")]
Fleet = Annotated[
    str | None,
    typer.Option(
        help=f"send reports to https://host/robots/NAME or mqtts://broker/robots/NAME, with the token in {TOKEN}",
        metavar="URL",
    ),
]


def known_kind(by: str) -> None:
    """Refuse what is no way in which robots are put together."""
    from robophm.fleet.cohorts import KINDS  # with all that learns

    if by not in KINDS:
        raise DataError(f"--by {by!r:.40}: expected {' or '.join(KINDS)}{nearest(by, KINDS)}")


def fleet_address(text: str, store: str | None) -> FleetAddress:
    """Return where a robot reports to. Raises RobophmError where that is none, or a store or token is missing."""
    from robophm.fleet.address import FleetAddress

    found = FleetAddress.of(text)
    if store is None:
        raise RobophmError("--fleet: what waits to be sent is kept in the robot's store; expected --store too")
    if not os.environ.get(TOKEN):
        raise RobophmError(f"--fleet: expected the robot's token in {TOKEN}, as robophm fleet token printed it")
    if found.over_mqtt:
        from robophm.transports.mqtt.connection import paho

        paho()
    return found


def sender(store: str, robot: str, fleet: FleetAddress) -> Sender:
    """Begin to send a robot's reports, by its identity in its store; what is in the way is said as warnings."""
    from robophm.fleet.sender import Sender

    return Sender(store, robot, fleet, os.environ[TOKEN], warn)
