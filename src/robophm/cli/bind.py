"""``robophm bind``: bindings of a design's inputs, proposed by what recordings have, with the values seen."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.drafts import print_bindings
from robophm.cli.shared.options import Design, Json
from robophm.cli.shared.output import console, may_write, print_json
from robophm.core.errors import RobophmError, nearest
from robophm.design.file import load, rewrite
from robophm.drafting.binding import bound_text
from robophm.drafting.bindings import Proposal, limits_of, proposals
from robophm.drafting.seen import Seen, look

SHOWN = 5
"""Signals that are named where none fits."""


def command(
    design: Design,
    bags: Annotated[list[Path], typer.Argument(help="recordings, or folders of recordings", metavar="BAGS")],
    urdf: Annotated[Path | None, typer.Option(help="URDF of the robot: its limits turn an effort into a load")] = None,
    accept: Annotated[list[str] | None, typer.Option(help="'PART: INPUT', as listed; may be repeated")] = None,
    yes: Annotated[bool, typer.Option("--yes", help="accept all proposals")] = False,
    as_json: Json = False,
) -> None:
    """Propose recorded signals for the inputs of a design, and write those that you accept."""
    may_write(design, *bags)
    robot = load(design)
    seen = look(bags)
    found, notes = proposals(robot, seen, limits_of(urdf))
    asks = not (yes or accept or as_json) and sys.stdin.isatty() and sys.stdout.isatty()
    if not as_json:
        print_bindings(found, notes)
    accepted = found if yes else _named(found, accept or ()) if accept else _asked(found) if asks else []
    if accepted:
        rewrite(design, bound_text(design, accepted))
    if as_json:
        document = [{"part": one.part, "input": one.input, "binding": dict(one.binding), "seen": one.seen,
                     "assumed": one.assumed, "accepted": one in accepted} for one in found]  # fmt: skip
        print_json({"robot": robot.name, "proposals": document, "not_bound": notes})
        return
    said = f"{len(accepted)} of {len(found)} written to {design}" if accepted else "nothing written"
    more = ""
    if not accepted and (found or not notes):
        more = "; --yes accepts all, --accept 'PART: INPUT' some" if found else _why_none(seen)
    console().print(f"{said}{more}", markup=False, soft_wrap=True)


def _why_none(seen: Seen) -> str:
    """Why nothing could be proposed, with some of what is there."""
    some = ", ".join(one.name for one in seen.signals[:SHOWN])
    more = f" and {len(seen.signals) - SHOWN} more" if len(seen.signals) > SHOWN else ""
    return (
        f": no input of the design fits {some}{more} by its name"
        if some
        else ": no signal that parts answer to is there"
    )


def _named(found: Sequence[Proposal], accept: Sequence[str]) -> list[Proposal]:
    by_name = {name_of(one): one for one in found}
    for name in accept:
        if name not in by_name:
            raise RobophmError(f"--accept {name!r:.80}: no such proposal{nearest(name, by_name)}")
    return [by_name[name] for name in dict.fromkeys(accept)]


def name_of(one: Proposal) -> str:
    """How a proposal is called: "joints/elbow servo: temperature"."""
    return f"{one.part or 'the robot'}: {one.input}"


def _asked(found: Sequence[Proposal]) -> list[Proposal]:
    return [one for one in found if typer.confirm(f"{name_of(one)} from {' and '.join(one.signals)}?", default=True)]
