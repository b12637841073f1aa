"""``robophm fleet token``: the token by which a robot writes its own reports, and no other's."""

from __future__ import annotations

import sys
from typing import Annotated
from urllib.parse import quote

import typer

from robophm.cli.shared.fleet import TOKEN, FleetStorePath
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import print_json
from robophm.fleet.store import FleetStore


def command(
    robot: Annotated[
        str, typer.Argument(help="name of the robot in the fleet; the former token of a known robot ends")
    ],
    store: FleetStorePath,
    site: Annotated[str | None, typer.Option(help="site where it works; default: as before")] = None,
    as_json: Json = False,
) -> None:
    """Make a robot's token, and print how it reports to the fleet with it."""
    with FleetStore(store, make=True) as fleet:
        token = fleet.add_token(robot, site)
    path = f"/robots/{quote(robot, safe='')}"
    if as_json:
        print_json({"robot": robot, "token": token, "path": path})
        return
    typer.echo(token)
    print(f"{robot} reports by `{TOKEN}=… robophm watch … --store … --fleet https://HOST:PORT{path}`; the token is "
          "kept nowhere", file=sys.stderr)  # fmt: skip
