"""``robophm learn``: what failures in the field say of the rates of a design."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.learned import print_learned, rate_json, robots_json, unstated_json
from robophm.cli.shared.options import Design, Force, Json, Prior
from robophm.cli.shared.output import console, may_make, print_json, warn
from robophm.cli.shared.stored_past import kept
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import DataError
from robophm.design.file import load, read, write
from robophm.design.robot import Robot
from robophm.health.unknown_rates import few
from robophm.interface.field import rated_alike
from robophm.learning.rates.evidence import with_evidence
from robophm.learning.rates.failure_log import Seen, read_failure_log
from robophm.learning.rates.rate_update import LearnedRate, UnstatedRate, learn, unstated
from robophm.monitoring.rate_history import each_once, rate_history
from robophm.stores import place_of

STORES = (".db", ".sqlite", ".sqlite3")
"""Suffixes of stores; all else is a log."""


def command(
    design: Design,
    logs: Annotated[
        list[Path], typer.Argument(help="failure logs (.csv, .yaml), or stores of robots (.db)", metavar="LOG…")
    ],
    prior: Prior = None,
    of: Annotated[str | None, typer.Option("--robot", help="rates of this one robot of the fleet")] = None,
    to: Annotated[Path | None, typer.Option(help="write the design with the evidence beside each rate")] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Update a design's failure rates by failures in the field."""
    if to is None:
        refuse_unused("rates that are not written (--to)", ("logs", "prior", "of"))
    may_make(to, *logs, force=force, suffixes=(".yaml", ".yml"))
    robot = load(design)
    seen: list[Seen] = []
    notes: list[str] = []
    for log, name in zip(logs, each_once([place_of(log) for log in logs]), strict=True):
        if log.suffix.lower() in STORES or place_of(log) != str(log):
            seen += rate_history(robot, kept(log, robot), name)
        else:
            found = read_failure_log(log, robot)
            seen += found.seen
            notes += found.notes
    if not any(one.exposure > 0 or one.failures for one in seen):
        raise DataError("nothing was seen: no failure and no exposure; expected a log or a robot that has worked")
    learned, unrated = learn(robot, seen, prior, of), unstated(robot, seen)
    notes += rated_alike(robot, learned)
    if to and not learned:
        raise DataError(
            f"nothing can be learned beside a rate: all that was seen is of unknown rate ({_paths(unrated)}); expected "
            "rates in the design"
        )
    text = with_evidence(read(design), str(design), learned) if to else ""
    for note in notes:
        warn(note)
    if as_json:
        print_json({"robot": robot.name, "rates": [rate_json(one) | {"robots": robots_json(one)} for one in learned],
                    "unknown": [unstated_json(one) for one in unrated], "notes": notes})  # fmt: skip
    else:
        _print(robot, learned, unrated)
    if to:
        write(to, text)
        if not as_json:
            but = f"; not of what is of unknown rate ({_paths(unrated)})" if unrated else ""
            console().print(f"Written to {to}, the evidence beside each rate{but}", markup=False, soft_wrap=True)


def _paths(unrated: Sequence[UnstatedRate]) -> str:
    return few([one.mode.path for one in unrated])


def _print(robot: Robot, learned: Sequence[LearnedRate], unrated: Sequence[UnstatedRate]) -> None:
    robots = {name for one in learned for name in one.robots}
    fleet = f", {len(robots)} robots" if len(robots) > 1 else ""
    print_learned(f"{robot.name}{fleet}", learned, unrated, "; --robot says of one", "--to NEW.YAML writes the design.")
