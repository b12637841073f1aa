"""``robophm store``: what is done to a store itself."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli import INVALID
from robophm.cli.shared.options import Design, Json, StoreOfRobot
from robophm.cli.shared.output import console, may_write, print_json, print_table, table
from robophm.cli.shared.stored_past import files_of
from robophm.core.errors import RobophmError, StoreError, nearest
from robophm.core.signal import HOUR
from robophm.design import identity_edits
from robophm.design.file import DesignFile, load, rewrite
from robophm.design.robot import Robot
from robophm.health.ledger_parts import Fate
from robophm.health.suspect_time import Verdict, said
from robophm.monitoring.stored_past import fates_in, identity_in, repair_past, settle_past, suspect_time_in
from robophm.report.words import moment_text, number_text
from robophm.stores import existing_store, place_of, restore_store

command = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None)


@command.callback()
def _store() -> None:
    """Manage a store, the file that keeps a robot's past."""


@command.command()
def parts(
    design: Design,
    path: StoreOfRobot,
    same: Annotated[
        list[str] | None,
        typer.Option(help="OLD is now called NEW, a part or a module; may be repeated", metavar="OLD=NEW"),
    ] = None,
    new: Annotated[list[str] | None, typer.Option(help="this part is new; may be repeated", metavar="PART")] = None,
    as_json: Json = False,
) -> None:
    """Say what becomes of the past of each part under a design; write the answers to what is asked into the design."""
    robot = load(design)
    if same or new:
        may_write(design, *files_of(path))
        file = DesignFile(design)
        for old, now in map(_pair, same or ()):
            _check(robot, now)
            identity_edits.state(file.document, "" if now == robot.name else now, identity_in(path, robot, old))
        for one in new or ():
            _check(robot, one)
            identity_edits.state(file.document, one, one)
        robot = rewrite(design, file.text())
    found = fates_in(path, robot)
    if as_json:
        print_json({"robot": robot.name, "parts": [{**one._asdict(), "said": one.said} for one in found]})
        return
    _print(robot, found, str(design), answered=bool(same or new))


def _pair(said: str) -> tuple[str, str]:
    old, equals, now = said.partition("=")
    if not (old and equals and now):
        raise RobophmError(f"--same {said!r:.80}: expected OLD=NEW, the paths of one part before and now")
    return old, now


def _check(robot: Robot, path: str) -> None:
    known = [robot.name, *robot.levels, *(part.path for part in robot.all_components() if not part.members)]
    if path not in known:
        raise RobophmError(f"no part or module '{path}' in the design{nearest(path, known)}")


def _print(robot: Robot, found: Sequence[Fate], design: str, *, answered: bool) -> None:
    out = console()
    if answered:
        out.print(f"written to {design}", markup=False)
    told = [one for one in found if one.kind != "same"]
    if told:
        rows = [[one.path, one.said] for one in told]
        print_table(out, table(f"What becomes of the past of {robot.name}", ("part", "its past"), rows))
    out.print(f"{len(found) - len(told)} parts go on as they are", markup=False)
    if any(one.kind == "asked" for one in told):
        out.print("--same OLD=NEW says that a part has the past of OLD; --new PART says that it has none", markup=False)


@command.command()
def repair(
    design: Design,
    path: StoreOfRobot,
    take_in: Annotated[
        bool,
        typer.Option("--take-in", help="the robot was at rest for the time by which its clock is ahead of its past"),
    ] = False,
    strike_out: Annotated[
        bool, typer.Option("--strike-out", help="that time did not pass; its past goes on from what the clock says")
    ] = False,
    as_json: Json = False,
) -> None:
    """Undo what damage, or a clock that was wrong, did to a robot's past; a copy is kept beside it.

    A damaged store is made anew of what is sound in it and of the last good state, kept in a file beside it. A jump by
    years that was counted is taken out, and what came behind it. Where time went on without a clock that was
    not plausible, the difference is taken in or struck out as you say.
    """
    if take_in and strike_out:
        raise RobophmError("--take-in or --strike-out? expected one of them")
    robot = load(design)
    if anew := restore_store(path):
        if as_json:
            print_json({"robot": robot.name, "repaired": {"said": anew.said}, "copy": str(anew.copy)})
        else:
            console().print(f"{path}: made anew: {'; '.join(anew.said)}. As it was: {anew.copy}", markup=False)
        return
    if take_in or strike_out:
        _settle(robot, path, "taken in" if take_in else "struck out", as_json=as_json)
        return
    found = repair_past(path, robot)
    done, copy = found or (None, None)
    if as_json:
        print_json({"robot": robot.name, "repaired": done._asdict() if done else None, "copy": copy and str(copy)})
        return
    out = console()
    if done:
        out.print(
            f"{path}: the clock had jumped from {moment_text(done.before)} by {(done.until - done.before) / HOUR:,.0f} "
            f"h; that is taken out, with {number_text(done.operating)} h of operation behind it. As it was: {copy}",
            markup=False, soft_wrap=True,
        )  # fmt: skip
    elif stretch := suspect_time_in(path, robot):
        out.print(f"{path}: {said(stretch)}: expected --take-in or --strike-out", markup=False, soft_wrap=True)
    else:
        out.print(f"{path}: no clock jumped by years in the past of {robot.name}; nothing is changed", markup=False)


@command.command()
def check(path: StoreOfRobot, as_json: Json = False) -> None:
    """Read all of a store, also while it is written, and say whether it is what was written."""
    with existing_store(path) as store:
        found = store.upkeep().faults()
        robots = [] if found else store.robots()
    if as_json:
        print_json({"store": path, "robots": robots, "faults": found})
    elif not found:
        console().print(f"{path}: all of it is what was written; robots: {', '.join(robots) or 'none'}", markup=False)
    if found and not as_json:
        raise StoreError(f"{path}: {'; '.join(found)}; robophm store repair goes back to the last good state")
    if found:
        raise typer.Exit(INVALID)


@command.command()
def copy(
    path: StoreOfRobot,
    to: Annotated[Path, typer.Option("--to", help="file to write; it must be new")],
    as_json: Json = False,
) -> None:
    """Copy a store into a new file, as it is at one moment, also while it is written."""
    may_write(to)
    with existing_store(path) as store:
        store.upkeep().copy_to(to)
    size = to.stat().st_size
    if as_json:
        print_json({"store": path, "copy": str(to), "bytes": size})
    else:
        console().print(f"{path}: copied to {to}, {size / 1e6:,.1f} MB", markup=False)


@command.command()
def compact(path: StoreOfRobot, as_json: Json = False) -> None:
    """Give back the space that became free as old reports were thinned; nobody may be watching meanwhile."""
    file = Path(place_of(path))
    with existing_store(path) as store:
        before = file.stat().st_size
        store.upkeep().compact()
        after = file.stat().st_size
    if as_json:
        print_json({"store": path, "bytes": {"before": before, "after": after}})
    else:
        console().print(f"{path}: {before / 1e6:,.1f} MB, now {after / 1e6:,.1f} MB", markup=False)


def _settle(robot: Robot, path: str, verdict: Verdict, *, as_json: bool) -> None:
    done, copy = settle_past(path, robot, verdict)
    if as_json:
        print_json({"robot": robot.name, "repaired": done._asdict(), "copy": str(copy)})
    else:
        console().print(f"{path}: {said(done)}. As it was: {copy}", markup=False, soft_wrap=True)
