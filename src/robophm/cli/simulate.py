"""``robophm simulate``: robots of a design work and really fail."""

from __future__ import annotations

import secrets
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.options import Design, Json
from robophm.cli.shared.output import console, print_json, print_table, progress_console, table
from robophm.cli.shared.progress import counted
from robophm.parts import completed
from robophm.simulation.fleet import simulate


def command(
    design: Design,
    output: Annotated[Path, typer.Option("--to", help="folder for the fleet; it must be new or empty")],
    robots: Annotated[int, typer.Option(help="number of robots")] = 20,
    tasks: Annotated[
        int, typer.Option(help="number of tasks of each robot; it also finishes that round of its plan")
    ] = 10,
    seed: Annotated[
        int | None, typer.Option(help="random seed; the same seed writes the same fleet; default: a new one")
    ] = None,
    uncertain_rates: Annotated[
        bool, typer.Option("--uncertain-rates", help="each robot draws its true rates from the design's uncertainty")
    ] = False,
    as_json: Json = False,
) -> None:
    """Simulate robots of a design that really fail: recordings, tasks and failures."""
    if seed is None:
        seed = secrets.randbits(32)
    with counted(progress_console(), "simulating") as advance:
        fleet = simulate(
            design, output, robots, tasks, seed, lambda done: advance(done, robots),
            uncertain_rates=uncertain_rates, library=completed,
        )  # fmt: skip
    if as_json:
        print_json({**asdict(fleet), "output": str(output)})
        return
    rows = [
        ("robots", f"{fleet.robots:,}"),
        ("tasks", f"{fleet.tasks:,}"),
        ("of them failed", f"{fleet.failed:,} ({fleet.failed / fleet.tasks:.1%})"),
        ("repaired before a task", f"{fleet.refused:,}"),
        ("parts failed", f"{fleet.parts_failed:,}"),
    ]
    out = console()
    print_table(out, table(f"Fleet in {output} (seed {seed})", ("", "count"), rows, figures=[1]))
