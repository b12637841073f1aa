"""Simulate a fleet from the command line."""

from __future__ import annotations

import secrets
from dataclasses import asdict
from pathlib import Path

from robophm.cli.output import console, print_json, print_table, progress_console, table
from robophm.cli.progress import counted
from robophm.simulation.fleet import simulate


def run(design: Path, output: Path, robots: int, tasks: int, seed: int | None, *, uncertain_rates: bool,
        as_json: bool) -> None:  # fmt: skip
    """Simulate and say in short what became of the robots."""
    if seed is None:
        seed = secrets.randbits(32)
    with counted(progress_console(), "simulating") as advance:
        fleet = simulate(
            design, output, robots, tasks, seed, lambda done: advance(done, robots), uncertain_rates=uncertain_rates
        )
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
