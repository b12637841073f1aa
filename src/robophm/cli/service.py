"""``robophm service``: a part of a robot failed, was replaced or repaired; its ledger knows from then on."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.options import Design, Json, stated_store
from robophm.cli.shared.output import console, print_json
from robophm.core.errors import RobophmError
from robophm.design.file import load
from robophm.design.robot import CLOCK_UNITS
from robophm.health.service import ServiceNote, services_of
from robophm.monitoring.service_notes import WAIT, note_service
from robophm.monitoring.stored_past import stored_past
from robophm.report.words import number_text, past_moment_text
from robophm.stores.events import WORDS


def command(
    design: Design,
    part: Annotated[str, typer.Argument(help="path of the component, or of its failure mode")],
    store: Annotated[
        str, typer.Option("--store", help="store with the robot's past, written by replay", callback=stated_store)
    ],
    replaced: Annotated[bool, typer.Option("--replaced", help="the part was replaced by a new one")] = False,
    repaired: Annotated[
        float | None,
        typer.Option(
            help="the part was repaired: the share of its age that remains, from 0 (as new) to 1 (as before)",
            metavar="SHARE",
        ),
    ] = None,
    failed: Annotated[
        bool,
        typer.Option(
            "--failed", help="the part had failed before the service; alone: it has failed and was not serviced yet"
        ),
    ] = False,
    struck_out: Annotated[
        bool, typer.Option("--struck-out", help="the last failure of the part that was told of was none")
    ] = False,
    by: Annotated[str, typer.Option(help="who reports it", metavar="NAME")] = "",
    note: Annotated[str, typer.Option(help="a remark to keep with it", metavar="TEXT")] = "",
    wait: Annotated[
        float,
        typer.Option(
            help="seconds to wait for an answer, while the robot is watched", min=0, max=3600, metavar="SECONDS"
        ),
    ] = WAIT,
    history: Annotated[bool, typer.Option("--history", help="list every service of the part so far")] = False,
    as_json: Json = False,
) -> None:
    """Record that a part was replaced or repaired, or that it failed, or had not."""
    served = replaced + (repaired is not None) + struck_out
    told = served == 1 or (served == 0 and failed)
    if served > 1 or (struck_out and failed) or not (told or history):
        raise RobophmError(
            "was it replaced or repaired, or has it failed? expected --replaced, --repaired SHARE, --failed or "
            "--struck-out, or --history to look"
        )
    if (by or note) and not told:
        raise RobophmError("--by and --note are of a service; expected e.g. --replaced or --failed too")
    robot, some = load(design), []
    if told:
        said = ServiceNote(part, repaired, failed, by, note, waits=not served, none=struck_out)
        some = note_service(store, robot, said, wait=wait)
    if history:
        with stored_past(store, robot) as (_, ledger):
            some = services_of(robot, ledger, part)
    if as_json:
        print_json({"robot": robot.name, "services": [one._asdict() for one in some]})
        return
    modes = {mode.key: mode for mode in robot.modes}
    out = console()
    if not some:
        out.print(f"{part}: has not failed, and was neither replaced nor repaired so far", markup=False)
    for one in some:
        path, unit = modes[one.mode].path, CLOCK_UNITS[modes[one.mode].clock]
        when = past_moment_text(one.time)
        done = f", at an effective age of {number_text(one.before[1])} {unit}"
        if one.kind not in ("failed", "struck out"):
            done = f"{' after it failed' if one.failed else ''}{done}; goes on at {number_text(one.after[1])} {unit}"
        who = f"{f', by {one.by}' if one.by else ''}{f': {one.note}' if one.note else ''}"
        out.print(f"{when}: {path} {WORDS.get(one.kind, one.kind)}{done}{who}", markup=False, soft_wrap=True)
