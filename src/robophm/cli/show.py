"""``robophm show``: what a design promises when new, drawn and tabulated."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from robophm.cli.shared.options import ChanceSeed, Design, Horizon, Json, Legacy, Unit, horizon_of
from robophm.cli.shared.output import (
    console,
    estimate_text,
    may_write,
    print_failures_to_come,
    print_json,
    print_table,
    print_unknown,
    table,
    write,
)
from robophm.cli.shared.promises import Promise, levels, promises
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import UnitError
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.groups.monte_carlo import Estimate, Wear, simulate
from robophm.health.failures_to_come import failures_to_come
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.report import plain
from robophm.health.unknown_rates import marked, marks, unknown
from robophm.report.dependence import dependence
from robophm.report.diagram_svg import diagram_svg
from robophm.report.diagram_text import diagram_text
from robophm.report.labels import part_labels
from robophm.report.outline import Label
from robophm.report.words import duration_text, number_text, percent_text, rate_text


def estimate(robot: Robot, hours: float, samples: int, seed: int) -> Estimate:
    """Reliability of the new robot after so many operating hours, nominal, by chance; also where nothing is exact."""
    units = {
        unit: [
            Wear(
                mode.life,
                robot.usage.per_operating_hour(mode.clock),
                mode.initial_exposure,
                mode.share * part.multiplicity,
            )
            for mode in part.modes
        ]
        for part in robot.all_components()
        for unit in part.units
    }
    return simulate(robot.diagram, units, hours, samples, seed=seed)


def draw(out: Console, robot: Robot, unit: str) -> None:
    """Every level's diagram as text."""
    label = _labels(robot, unit)
    out.print(robot.name, style="bold", markup=False)
    for path, module in levels(robot):
        if path:
            out.print(f"\n{path}", style="bold", markup=False)
        out.print(diagram_text(module.wiring, label, out.width), markup=False, soft_wrap=True)
        for note in dependence(robot, path):
            out.print(f"  {note}", markup=False, soft_wrap=True)
    out.print()


def svg_diagram(robot: Robot, unit: str) -> str:
    """The whole robot down to its components as one stand-alone SVG."""
    return diagram_svg(robot.diagram, _labels(robot, unit), standalone=True)


def promises_table(robot: Robot, found: Sequence[Promise], hours: float, unit: str) -> Table:
    """For people."""
    at = f"{number_text(hours)} h"
    columns = ["when new, nominal", f"λ at {at} of operation", f"R({at})", "MTTF, calendar"]
    if found[0].legacy_hazard_rate is not None:
        columns += ["λ, 2020 tool", f"R({at}), 2020 tool"]
    rows = []
    for one in found:
        indent = "  " * (one.path.count("/") + bool(one.path))
        rate, works, ahead = marks(one.unknown)
        row = [indent + (one.path.rpartition("/")[2] or robot.name), marked(rate, rate_text(one.hazard_rate, unit))]
        row.append(works + percent_text(one.reliability, one.unreliability))
        row.append(marked(ahead, duration_text(one.mean_time_to_failure)))
        if one.legacy_hazard_rate is not None and one.legacy_reliability is not None:
            row += [rate_text(one.legacy_hazard_rate, unit), percent_text(one.legacy_reliability)]
        rows.append(row)
    return table("", columns, rows, figures=range(1, len(columns)))


def _labels(robot: Robot, unit: str) -> Callable[[str], Label]:
    new = as_designed(Plant(robot))
    rates = {path: new.hazard_rate(module.diagram) for path, module in levels(robot)}
    components = zip(robot.all_components(), new.component_hazard_rates(), strict=True)
    left_out = {path: marks(unknown(new, module.diagram))[0] for path, module in levels(robot)}
    return part_labels(robot, rates | {part.path: float(rate) for part, rate in components}, unit, unknown=left_out)


def command(
    design: Design,
    hours: Annotated[float, typer.Option(help="operating hours at which to state λ and R")] = 1000.0,
    unit: Unit = "1/h",
    svg: Annotated[Path | None, typer.Option(help="also draw the diagram into this SVG file")] = None,
    horizon: Horizon = None,
    legacy: Legacy = False,
    monte_carlo: Annotated[
        int | None, typer.Option(min=1, max=1_000_000_000, help="only estimate R by so many simulated robots")
    ] = None,
    seed: ChanceSeed = 0,
    as_json: Json = False,
) -> None:
    """Draw a design and state what it promises when new."""
    if monte_carlo:
        estimated(design, hours, monte_carlo, seed, as_json=as_json)
    else:
        shown(design, hours, unit, svg, horizon_of(horizon), legacy=legacy, as_json=as_json)


def estimated(design: Path, hours: float, robots: int, seed: int, *, as_json: bool) -> None:
    """Say what so many simulated robots did in place of what the diagram gives. Raises RobophmError."""
    refuse_unused("simulated robots (--monte-carlo)", ("hours", "monte_carlo", "seed"))
    robot = _asked(design, hours, None)
    by_chance = estimate(robot, hours, robots, seed)
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
    robot = _asked(design, hours, svg)
    found = promises(robot, hours, legacy=legacy)
    if svg:
        write(svg, svg_diagram(robot, unit))
    new = as_designed(Plant(robot))
    median = new.remaining_life(robot.diagram).median
    to_come = failures_to_come({"nominal": new, "sensor_based": new}, robot.diagram, median, horizon)
    if as_json:
        modules = [plain(asdict(one)) for one in found]
        print_json(
            {"robot": robot.name, "hours": hours, "modules": modules, "failures_to_come": plain(asdict(to_come))}
        )
        return
    out = console()
    draw(out, robot, unit)
    print_table(out, promises_table(robot, found, hours, unit))
    print_unknown(found[0].unknown, robot)
    print_failures_to_come(to_come, both=False)


def _asked(design: Path, hours: float, svg: Path | None) -> Robot:
    if not 0 <= hours < float("inf"):
        raise UnitError(f"--hours {hours:g}: expected a number of at least 0")
    may_write(svg, design)
    return load(design)
