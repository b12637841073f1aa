"""``robophm service``: a part of a robot was replaced or repaired; its ledger knows from then on."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.options import Design, Json, stated_store
from robophm.cli.shared.output import console, print_json
from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.health.service import ServiceNote, services_of
from robophm.monitoring.service_notes import WAIT, note_service
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
    by: Annotated[str, typer.Option(help="who says so", metavar="NAME")] = "",
    note: Annotated[str, typer.Option(help="what is to be remembered of it", metavar="TEXT")] = "",
    wait: Annotated[
        float, typer.Option(help="for an answer, where the robot is watched", min=0, max=3600, metavar="SECONDS")
    ] = WAIT,
    history: Annotated[bool, typer.Option("--history", help="list every service of it so far")] = False,
    as_json: Json = False,
) -> None:
    """Tell a robot's ledger that a part was replaced, or repaired."""
    if replaced + (repaired is not None) != 1 and not (history and not replaced and repaired is None):
        raise RobophmError("was it replaced or repaired? expected --replaced or --repaired SHARE, or --history to look")
    if failed and not replaced and repaired is None:
        raise RobophmError("--failed says why it was served; expected --replaced or --repaired SHARE with it")
    if (by or note) and not replaced and repaired is None:
        raise RobophmError("--by and --note are of a service; expected --replaced or --repaired SHARE with them")
    robot, some = load(design), []
    if replaced or repaired is not None:
        some = note_service(store, robot, ServiceNote(part, repaired, failed, by, note), wait=wait)
    if history:
        with stored_past(store, robot) as (_, ledger):
            some = services_of(robot, ledger, part)
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
            f"{number_text(one.before[1])}; goes on at {number_text(one.after[1])}"
            f"{f', by {one.by}' if one.by else ''}{f': {one.note}' if one.note else ''}",
            markup=False, soft_wrap=True,
        )  # fmt: skip
