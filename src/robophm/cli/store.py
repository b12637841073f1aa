"""``robophm store``: what is done to a store itself."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.options import Design, Json, stated_store
from robophm.cli.shared.output import console, print_json
from robophm.core.signal import HOUR
from robophm.design.file import load
from robophm.monitoring.stored_past import repair_past
from robophm.report.words import moment_text, number_text

command = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None)


@command.callback()
def _store() -> None:
    """Look after a store, where a robot's past is kept."""


@command.command()
def repair(
    design: Design,
    path: Annotated[
        str, typer.Option("--store", help="the robot's past, as kept by replay or watch", callback=stated_store)
    ],
    as_json: Json = False,
) -> None:
    """Take a jump of the clock by years out of a robot's past, and what came behind it; a copy is kept beside it."""
    robot = load(design)
    found = repair_past(path, robot)
    done, copy = found or (None, None)
    if as_json:
        print_json({"robot": robot.name, "repaired": done._asdict() if done else None, "copy": copy and str(copy)})
        return
    out = console()
    if not done:
        out.print(f"{path}: no clock jumped by years in the past of {robot.name}; nothing is changed", markup=False)
        return
    out.print(
        f"{path}: the clock had jumped from {moment_text(done.before)} by {(done.until - done.before) / HOUR:,.0f} h; "
        f"that is taken out, with {number_text(done.operating)} h of operation behind it. As it was: {copy}",
        markup=False, soft_wrap=True,
    )  # fmt: skip
