"""``robophm fleet simulate``: robots that really fail, told to a running fleet."""

from __future__ import annotations

import secrets
import time
from contextlib import closing
from typing import Annotated, Any
from urllib.parse import quote

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Design, Json
from robophm.cli.shared.output import console, print_json, progress_console
from robophm.cli.shared.progress import counted
from robophm.core.errors import RobophmError
from robophm.core.units import quantity
from robophm.fleet.address import FleetAddress
from robophm.fleet.simulated import simulated_robots, tell
from robophm.fleet.store import FleetStore
from robophm.report.words import count_text


def command(
    design: Design,
    store: FleetStorePath,
    fleet: Annotated[str, typer.Option(help="address of the service that uses that store", metavar="URL")],
    robots: Annotated[int, typer.Option(help="number of robots")] = 20,
    tasks: Annotated[
        int, typer.Option(help="number of tasks of each robot; it also finishes that round of its plan")
    ] = 10,
    every: Annotated[str, typer.Option(help="time between two reports of a robot")] = "1 h",
    seed: Annotated[
        int | None, typer.Option(help="random seed; the same seed simulates the same robots; default: a new one")
    ] = None,
    as_json: Json = False,
) -> None:
    """Simulate robots that work, really fail, and report to a running fleet; their records end now."""
    seed = secrets.randbits(32) if seed is None else seed
    seconds = quantity(every, "s")
    if not 1 <= seconds <= 1e9:
        raise RobophmError(f"--every {every!r:.40}: expected a second or more")
    service = FleetAddress.of(f"{fleet.rstrip('/')}/robots/any").service
    found: list[dict[str, Any]] = []
    made = simulated_robots(design, robots, tasks, seed, seconds, time.time_ns())
    with FleetStore(store) as opened, closing(made), counted(progress_console(), "simulating") as advance:
        for robot in made:
            name = f"simulated-{seed}-{robot.name.removeprefix('robot-')}"
            if opened.knows(name):
                raise RobophmError(f"{store}: there is a robot '{name}' already; expected another --seed")
            tell(robot, FleetAddress.of(f"{service}/robots/{quote(name, safe='')}"), opened.add_token(name))
            events = [one._asdict() for one in robot.events]
            found.append({"robot": name, "reports": len(robot.reports), "events": events})
            advance(len(found), robots)
    if as_json:
        print_json({"seed": seed, "robots": found})
        return
    failed = [one["part"] for robot in found for one in robot["events"] if one["what"] == "failed"]
    console().print(
        f"{count_text(len(found))} robots (seed {seed}) have sent {count_text(sum(one['reports'] for one in found))} "
        f"reports; {count_text(len([*filter(None, failed)]))} parts of them failed", markup=False,
    )  # fmt: skip
