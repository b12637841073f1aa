"""Options of commands about a fleet, and the sending of a robot's reports to one."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated
from urllib.parse import quote

import typer

from robophm.cli.shared.output import warn
from robophm.core.errors import DataError, RobophmError, nearest

if TYPE_CHECKING:
    from robophm.fleet.address import FleetAddress
    from robophm.fleet.sender import Sender

TOKEN = "ROBOPHM_FLEET_TOKEN"
"""The variable of the environment that holds a robot's token."""

TOKENS = "ROBOPHM_FLEET_TOKENS"
"""The variable that names a file with the tokens of several robots: a line for each, its name in the fleet first."""

EACH = "/robots/*"
"""End of the address of several robots, in which each puts its own name."""

FleetStorePath = Annotated[
    str, typer.Option("--store", help="the fleet's store: a SQLite file, or postgresql://host/database")
]
Designs = Annotated[list[Path], typer.Argument(help="design files of the robots", metavar="ROBOT.YAML…")]
Fleet = Annotated[
    str | None,
    typer.Option(
        help=f"send reports to https://host/robots/NAME or mqtts://broker/robots/NAME, with the token in {TOKEN}; of "
        f"several robots to https://host/robots/*, with the tokens in the file that {TOKENS} names",
        metavar="URL",
    ),
]


def known_kind(by: str) -> None:
    """Refuse what is no way in which robots are put together."""
    from robophm.fleet.cohorts import KINDS  # with all that learns

    if by not in KINDS:
        raise DataError(f"--by {by!r:.40}: expected {' or '.join(KINDS)}{nearest(by, KINDS)}")


def fleet_address(text: str, store: str | None, robot: str | None = None) -> FleetAddress:
    """Return where a robot reports to; ``robot``: its name in the fleet, where several share an address.

    Raises RobophmError where that is none, or a store or token is missing.
    """
    from robophm.fleet.address import FleetAddress

    if robot is not None:
        if not text.endswith(EACH):
            raise RobophmError(f"--fleet {text!r:.100}: is of one robot; expected https://host{EACH} of several")
        text = text.removesuffix("*") + quote(robot, safe="")
    found = FleetAddress.of(text)
    if store is None:
        raise RobophmError("--fleet: what waits to be sent is kept in the robot's store; expected --store too")
    token_of(robot)
    if found.over_mqtt:
        from robophm.transports.mqtt.connection import paho

        paho()
    return found


def token_of(robot: str | None) -> str:
    """Return the token of the robot that is watched, or of one of several by its name. Raises RobophmError."""
    if robot is None:
        if not (token := os.environ.get(TOKEN)):
            raise RobophmError(f"--fleet: expected the robot's token in {TOKEN}, as robophm fleet token printed it")
        return token
    if not (path := os.environ.get(TOKENS)):
        raise RobophmError(f"--fleet: expected the name of a file with the tokens of the robots in {TOKENS}")
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeError) as error:
        raise RobophmError(
            f"{TOKENS}: {path} cannot be read: {getattr(error, 'strerror', None) or 'no text'}"
        ) from None
    tokens = dict(line.rsplit(None, 1) for line in lines if len(line.split()) > 1)
    if robot not in tokens:
        raise RobophmError(f"{path}: no token of {robot}{nearest(robot, tokens)}; expected a line '{robot} TOKEN'")
    return tokens[robot]


def sender(store: str, identity: str, fleet: FleetAddress, robot: str | None = None) -> Sender:
    """Begin to send a robot's reports, by its identity in its store; what is in the way is said as warnings.

    ``robot``: its name, where it is one of several.
    """
    from robophm.fleet.sender import Sender

    def told(words: str) -> None:
        warn(f"{robot}: {words}" if robot else words)

    return Sender(store, identity, fleet, token_of(robot), told)
