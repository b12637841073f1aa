"""``robophm fleet trend``: how the whole fleet was, day by day."""

from __future__ import annotations

import time
from typing import Annotated

import numpy as np
import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.past_span import span_of
from robophm.core.signal import DAY
from robophm.fleet.questions import horizon_of
from robophm.fleet.store import FleetStore
from robophm.fleet.trend import first_day, trend
from robophm.report.curve import sparkline
from robophm.report.words import count_text, duration_text, failure_text, moment_text, number_text

SPAN = 30 * DAY
"""The time until now that is told of, unless another is asked for [ns]."""


def command(
    store: FleetStorePath,
    horizon: Annotated[str, typer.Option(help="calendar time considered: '1 day', '1 week' or '30 day'")] = "1 week",
    start: Annotated[
        str | None, typer.Option("--from", metavar="TIME", help="start, e.g. 2026-03-04; else 30 days before the end")
    ] = None,
    end: Annotated[str | None, typer.Option("--to", metavar="TIME", help="end, itself not included; else now")] = None,
    as_json: Json = False,
) -> None:
    """How the fleet was, day by day: robots expected to fail, and how their probabilities spread."""
    hours = horizon_of(horizon)
    first, last = span_of(start, end)
    last = time.time_ns() if last is None else last
    with FleetStore(store) as fleet:
        begun = first_day(fleet)
        first = max(last - SPAN if first is None else first, last if begun is None else begun)
        days = [*trend(fleet, hours, first, last)]
    if as_json:
        print_json({"horizon": hours, "days": [one._asdict() for one in days]})
        return
    out = console()
    if not days:
        out.print("No robot has told of that time", markup=False)
        return
    rows = [
        [moment_text(one.begin)[:10], count_text(one.robots), number_text(one.expected),
         *map(failure_text, (*one.quantiles, one.worst))] for one in days
    ]  # fmt: skip
    columns = ("day", "robots", "expected to fail", "P, 5 % of robots", "median", "95 %", "worst")
    print_table(
        out, table(f"P(fails within {duration_text(hours)}), by day in UTC", columns, rows, figures=range(1, 7))
    )
    course = np.array([one.expected / one.robots for one in days])
    if len(days) > 1:
        out.print(f"mean P of a robot: {sparkline(course, 60)}", markup=False)
