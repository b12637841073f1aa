"""``robophm show``: what a design promises when new, drawn and tabulated."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from robophm.cli.shared.health_output import print_failures_to_come, print_unknown
from robophm.cli.shared.options import ChanceSeed, Design, Horizon, Json, Legacy, Unit, horizon_of, time_option
from robophm.cli.shared.output import console, may_write, print_json, print_table, table, write
from robophm.cli.shared.unused import refuse_unused
from robophm.core.json_values import plain
from robophm.design.file import load
from robophm.design.importers.legacy.figures import legacy_rate, legacy_reliability
from robophm.design.robot import Robot
from robophm.health.failures_to_come import failures_to_come
from robophm.health.monte_carlo import survival_by_monte_carlo
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import marked, marks, unknown
from robophm.health.when_new import NominalFigures, hazard_rates, nominal_figures
from robophm.report.dependence import dependence
from robophm.report.diagram_svg import diagram_svg
from robophm.report.diagram_text import diagram_text
from robophm.report.fault_trees import estimate_text
from robophm.report.labels import part_labels
from robophm.report.outline import Label
from robophm.report.surroundings import environments_in_words, qualities_in_words
from robophm.report.words import duration_text, number_text, percent_text, rate_text


def draw(out: Console, new: Outlook, unit: str) -> None:
    """Print every level's diagram as text."""
    label, robot = _labels(new, unit), new.plant.robot
    out.print(robot.name, style="bold", markup=False)
    for path, module in robot.levels.items():
        if path:
            out.print(f"\n{path}", style="bold", markup=False)
        out.print(diagram_text(module.wiring, label, out.width), markup=False, soft_wrap=True)
        for note in dependence(robot, path):
            out.print(f"  {note}", markup=False, soft_wrap=True)
    out.print()


Old = tuple[float | None, float | None]
"""Hazard rate [1/h] and reliability of a level by the 2020 tool; None unless they are asked for."""


def promises_table(robot: Robot, found: Sequence[tuple[NominalFigures, Old]], hours: float, unit: str) -> Table:
    """Return a table of promises for people."""
    at = f"{number_text(hours)} h"
    columns = ["when new, nominal", f"λ at {at} of operation", f"R({at})", "MTTF, calendar"]
    if found[0][1][0] is not None:
        columns += ["λ, 2020 tool", f"R({at}), 2020 tool"]
    rows = []
    for one, (old_rate, old_works) in found:
        indent = "  " * (one.path.count("/") + bool(one.path))
        rate, works, ahead = marks(one.unknown)
        row = [indent + (one.path.rpartition("/")[2] or robot.name), marked(rate, rate_text(one.hazard_rate, unit))]
        row.append(works + percent_text(one.reliability, one.unreliability))
        row.append(marked(ahead, duration_text(one.mean_time_to_failure)))
        if old_rate is not None and old_works is not None:
            row += [rate_text(old_rate, unit), percent_text(old_works)]
        rows.append(row)
    return table("", columns, rows, figures=range(1, len(columns)))


def _labels(new: Outlook, unit: str) -> Callable[[str], Label]:
    left_out = {path: marks(unknown(new, module.diagram))[0] for path, module in new.plant.robot.levels.items()}
    return part_labels(new.plant.robot, hazard_rates(new), unit, unknown=left_out)


def command(
    design: Design,
    hours: Annotated[float, time_option("--at", "time of operation at which λ and R are stated")] = 1000.0,
    unit: Unit = "1/h",
    svg: Annotated[Path | None, typer.Option(help="also draw the diagram, as an SVG file")] = None,
    horizon: Horizon = None,
    legacy: Legacy = False,
    monte_carlo: Annotated[
        int | None, typer.Option(min=1, max=1_000_000_000, help="only estimate R, by simulating this many robots")
    ] = None,
    seed: ChanceSeed = 0,
    as_json: Json = False,
) -> None:
    """Draw a design and give its figures when new."""
    if monte_carlo:
        estimated(design, hours, monte_carlo, seed, as_json=as_json)
    else:
        shown(design, hours, unit, svg, horizon_of(horizon), legacy=legacy, as_json=as_json)


def estimated(design: Path, hours: float, robots: int, seed: int, *, as_json: bool) -> None:
    """Say what so many simulated robots did in place of what the diagram gives. Raises RobophmError."""
    refuse_unused("simulated robots (--monte-carlo)", ("hours", "monte_carlo", "seed"))
    robot = _asked(design, None)
    by_chance = survival_by_monte_carlo(robot, hours, robots, seed=seed)
    if as_json:
        print_json({"robot": robot.name, "hours": hours, "seed": seed, **asdict(by_chance)})
        return
    console().print(
        f"{robot.name}, new, nominal: R({hours:g} h) = {estimate_text(by_chance)} ({by_chance.samples:,} simulated)",
        markup=False, soft_wrap=True,
    )  # fmt: skip


def shown(
    design: Path, hours: float, unit: str, svg: Path | None, horizon: float | None, *, legacy: bool, as_json: bool
) -> None:
    """Draw, and tabulate what is promised. Raises RobophmError."""
    in_words = svg or not as_json
    refuse_unused(
        f"a design{'' if in_words else ' as JSON, in 1/h'}",
        ("hours", "svg", "legacy", "horizon", *["unit"] * bool(in_words)),
    )
    robot = _asked(design, svg)
    new = as_designed(Plant(robot))
    found = [
        (one, (legacy_rate(module), legacy_reliability(module, hours)) if legacy else (None, None))
        for one, module in zip(nominal_figures(new.plant, hours), robot.levels.values(), strict=True)
    ]
    if svg:  # the whole robot down to its components
        write(svg, diagram_svg(robot.diagram, _labels(new, unit), standalone=True))
    median = new.remaining_life(robot.diagram).median
    to_come = failures_to_come({"nominal": new, "sensor_based": new}, robot.diagram, median, horizon)
    if as_json:
        modules = [
            plain({**asdict(one), "legacy_hazard_rate": rate, "legacy_reliability": works})
            for one, (rate, works) in found
        ]
        print_json(
            {"robot": robot.name, "hours": hours, "modules": modules, "failures_to_come": plain(asdict(to_come))}
        )
        return
    out = console()
    draw(out, new, unit)
    print_table(out, promises_table(robot, found, hours, unit))
    for line in (*environments_in_words(robot), *qualities_in_words(robot)):
        out.print(line, markup=False, soft_wrap=True)
    print_unknown(found[0][0].unknown, robot)
    print_failures_to_come(to_come, both=False)


def _asked(design: Path, svg: Path | None) -> Robot:
    may_write(svg, design)
    return load(design)
