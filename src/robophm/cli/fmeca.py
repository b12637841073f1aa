"""``robophm fmeca``: what failures do, and what sees them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.options import Design, Force, Json, time_option
from robophm.cli.shared.output import console, may_make, print_json, print_table, table, write
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.core.json_values import plain
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.effects import Effect, check_severities
from robophm.interface.faults import fmeca
from robophm.report.fmeca_page import effect_text, fmeca_csv, fmeca_page, unknown_words
from robophm.report.words import more_text, number_text, share_text


def command(
    design: Design,
    sensors: Annotated[
        Path | None, typer.Option(help="a table: sensor, part, detects, false alarm, price, fitted")
    ] = None,
    hours: Annotated[float, time_option("--within", "time of operation of a new robot", above=True)] = 1000.0,
    severity: Annotated[
        list[str] | None,
        typer.Option(
            metavar="WHAT=1…10", help="severity of the loss of: robot, redundancy, nothing, a function or a part"
        ),
    ] = None,
    to: Annotated[Path | None, typer.Option(help="write the whole table, .csv or .html")] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Failure modes, effects and criticality (FMECA), with effects from the robot's structure."""
    run(design, sensors, hours, tuple(severity or ()), to, force=force, as_json=as_json)


def run(
    path: Path, table_of_sensors: Path | None, hours: float, severities: tuple[str, ...], to: Path | None, *,
    force: bool, as_json: bool,
) -> None:  # fmt: skip
    """Print or write the effects of every failure mode."""
    may_make(to, path, *([table_of_sensors] if table_of_sensors else []), force=force, suffixes=(".csv", ".html"))
    if to is None:
        refuse_unused("effects that are not written (--to)", ("sensors", "hours", "severity"))
    robot = load(path)
    done = fmeca(robot, table_of_sensors, hours=hours, severities=_severities(severities, robot))
    found, sees = done.effects, done.coverage
    if to:
        write(to, fmeca_csv(found, sees) if to.suffix == ".csv" else fmeca_page(robot.name, found, sees, hours))
    if as_json:
        modes = [{**asdict(one), "rpn": one.rpn, "criticality": one.criticality} for one in found]
        print_json({"robot": robot.name, "hours": hours, "modes": plain(modes), "coverage": sees})
        return
    _print_effects(robot, found, hours, to)


def _severities(texts: tuple[str, ...], robot: Robot) -> dict[str, int]:
    found = {}
    for text in texts:
        name, _, value = text.rpartition("=")
        if not value.strip().isascii() or not value.strip().isdigit() or not 1 <= int(value) <= 10:
            raise RobophmError(f"--severity {text[:60]!r}; expected e.g. drive=9, from 1 to 10")
        found[name.strip()] = int(value)
        try:
            check_severities(found, robot)
        except RobophmError as error:
            raise RobophmError(f"--severity: {error}") from None
    return found


def _print_effects(robot: Robot, found: Sequence[Effect], hours: float, to: Path | None) -> None:
    out = console()
    columns = ["failure mode", "end effect", "within", "seen", "S", "O", "D", "RPN", "criticality"]
    rows = [
        [one.mode, effect_text(one)[1], number_text(one.probability, 3), share_text(one.detected),
         str(one.severity), str(one.occurrence), str(one.detection), str(one.rpn), number_text(one.criticality, 3)]
        for one in found[:40]
    ]  # fmt: skip
    title = f"What failures do to {robot.name}, within {number_text(hours)} h of operation"
    print_table(out, table(title, columns, rows, figures=range(2, len(columns))))
    if len(found) > len(rows):
        out.print(f"{more_text(len(found) - len(rows), 'listed')}; --to FMECA.CSV has all")
    for words in unknown_words(found):
        out.print(words, style="yellow", markup=False)
    out.print("S severity, O occurrence, D detection (10: nothing sees it), RPN their product")
    if to:
        out.print(f"Written to {to}", markup=False, soft_wrap=True)
