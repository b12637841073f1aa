"""``robophm service``: a part of a robot was replaced or repaired; its ledger knows from then on."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.options import Design, Json, stated_store
from robophm.cli.shared.output import console, print_json
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.health.service import repair, replace, services_of
from robophm.monitoring.stored_past import stored_past
from robophm.report.words import moment_text, number_text


def command(
    design: Design,
    part: Annotated[str, typer.Argument(help="path of the component, or of its failure mode")],
    store: Annotated[str, typer.Option("--store", help="the robot's past, as kept by replay", callback=stated_store)],
    replaced: Annotated[bool, typer.Option("--replaced", help="a new one was put in")] = False,
    repaired: Annotated[
        float | None,
        typer.Option(help="it was repaired: the share of its age that remains, 0 as new, 1 as before", metavar="SHARE"),
    ] = None,
    failed: Annotated[bool, typer.Option("--failed", help="it had failed; else it was served before")] = False,
    history: Annotated[bool, typer.Option("--history", help="list every service of it so far")] = False,
    as_json: Json = False,
) -> None:
    """Tell a robot's ledger that a part was replaced, or repaired."""
    if replaced + (repaired is not None) != 1 and not (history and not replaced and repaired is None):
        raise RobophmError("was it replaced or repaired? expected --replaced or --repaired SHARE, or --history to look")
    if failed and not replaced and repaired is None:
        raise RobophmError("--failed says why it was served; expected --replaced or --repaired SHARE with it")
    robot = load(design)
    with stored_past(store, robot, change=replaced or repaired is not None) as (kept, ledger):
        before = len(ledger.services)
        if replaced:
            replace(robot, ledger, part, failed=failed)
        elif repaired is not None:
            repair(robot, ledger, part, repaired, failed=failed)
        if len(ledger.services) > before:
            kept.save(robot.identity, ledger.to_json())
    some = services_of(robot, ledger, part) if history else ledger.services[before:]
    if as_json:
        print_json({"robot": robot.name, "services": [one._asdict() for one in some]})
        return
    paths = {mode.key: mode.path for mode in robot.modes}
    out = console()
    if not some:
        out.print(f"{part}: neither replaced nor repaired so far", markup=False)
    for one in some:
        path = paths[one.mode]
        when = moment_text(one.time) if one.time > SECOND else "before its first recording"
        out.print(
            f"{when}: {path} {one.kind}{' after it failed' if one.failed else ''}, at an effective age of "
            f"{number_text(one.before[1])}; goes on at {number_text(one.after[1])}",
            markup=False, soft_wrap=True,
        )  # fmt: skip
