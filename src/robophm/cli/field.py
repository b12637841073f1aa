"""The commands about what the field says: failures, life data, wear, maintenance, diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.output import Json

Design = Annotated[Path, typer.Argument(help="the robot's design file", metavar="ROBOT.YAML")]
Force = Annotated[bool, typer.Option("--force", help="also where that file exists")]


def learn(
    design: Design,
    logs: Annotated[
        list[Path], typer.Argument(help="failure logs (.csv, .yaml), or stores of robots (.db)", metavar="LOG…")
    ],
    prior: Annotated[
        str | None, typer.Option(help="what stated rates count as: '10000 h', '2 failures'; default the design's, or 1")
    ] = None,
    of: Annotated[str | None, typer.Option("--robot", help="rates of this one robot of the fleet")] = None,
    to: Annotated[Path | None, typer.Option(help="write the design with the evidence beside each rate")] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """What failures in the field say of a design's rates."""
    from robophm.cli.learn import run

    run(design, logs, prior, of, to, force=force, as_json=as_json)


def service(
    design: Design,
    part: Annotated[str, typer.Argument(help="path of the component, or of its failure mode")],
    store: Annotated[Path, typer.Option("--store", help="the robot's past, as kept by replay")],
    repaired: Annotated[
        float | None,
        typer.Option(help="it was repaired: the share of its age that remains, 0 as new, 1 as before", metavar="SHARE"),
    ] = None,
    failed: Annotated[bool, typer.Option("--failed", help="it had failed; else it was served before")] = False,
    history: Annotated[bool, typer.Option("--history", help="list every service so far")] = False,
    as_json: Json = False,
) -> None:
    """Tell a robot's ledger that a part was replaced, or repaired."""
    from robophm.cli.service import run

    run(design, part, store, repaired, failed=failed, history=history, as_json=as_json)


COMMANDS: tuple[Callable[..., None], ...] = (learn, service)
