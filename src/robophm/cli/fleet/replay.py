"""``robophm fleet replay``: the health of many robots after what they recorded."""

from __future__ import annotations

import os
from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.options import Json, SkipMissing
from robophm.cli.shared.output import console, print_json, print_table, progress_console, table, warn
from robophm.cli.shared.progress import counted
from robophm.core.errors import RobophmError
from robophm.fleet.recorded import Replayed, recorded_robots, replayed
from robophm.monitoring.replay import MOST_JOBS
from robophm.report.words import duration_text, rate_text


def command(
    designs: Annotated[
        Path, typer.Argument(help="the design of all robots, or a folder of designs named as their robots")
    ],
    recordings: Annotated[Path, typer.Argument(help="a folder with one folder of recordings for each robot")],
    stores: Annotated[Path, typer.Option("--stores", help="folder for the stores of the robots, NAME.db")],
    jobs: Annotated[
        int | None,
        typer.Option(help="number of robots at once; default: the number of processors", min=1, max=MOST_JOBS),
    ] = None,
    skip_missing: SkipMissing = False,
    as_json: Json = False,
) -> None:
    """Compute the health of many robots from their recordings; an interrupted run is continued."""
    robots = recorded_robots(designs, recordings)
    found: list[Replayed] = []
    done = replayed(robots, stores, jobs or os.cpu_count() or 1, skip_missing=skip_missing)
    with closing(done), counted(progress_console(), "replaying") as advance:
        for one in done:
            found.append(one)
            advance(len(found), len(robots))
    found.sort()
    if as_json:
        print_json({"robots": [one._asdict() for one in found]})
    else:
        columns = ("robot", "state", "λ sensor", "RUL median")
        print_table(console(), table("", columns, [_row(one) for one in found]))
    failed = [one for one in found if one.error]
    for one in failed:
        warn(f"{one.robot}: {one.error}")
    if failed:
        raise RobophmError(f"{len(failed)} of {len(found)} robots could not be replayed")


def _row(one: Replayed) -> list[str]:
    if one.health is None:
        return [one.robot, "–", "–", "–"]
    seen = one.health["subjects"][0]["sensor_based"]
    rate, left = seen["hazard_rate"], seen["remaining_life"]["median"]
    return [one.robot, one.health["state"], "–" if rate is None else rate_text(float(rate), "1/h"),
            "–" if left is None else duration_text(float(left))]  # fmt: skip
