"""``robophm fleet worst``: which robots fail first."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.fleet.commit import BELIEVED
from robophm.fleet.questions import Risk, horizon_of, worst
from robophm.fleet.store import FleetStore
from robophm.report.words import count_text, duration_text, failure_text, moment_text, more_text, percent_text


def command(
    store: FleetStorePath,
    horizon: Annotated[str, typer.Option(help="calendar time considered: '1 day', '1 week' or '30 day'")] = "1 week",
    most: Annotated[int, typer.Option(min=1, max=100_000, help="number of robots to list")] = 20,
    as_json: Json = False,
) -> None:
    """The robots that will most probably fail within a horizon, worst first, and the parts that cause it."""
    hours = horizon_of(horizon)
    with FleetStore(store) as fleet:
        found = worst(fleet, hours, most)
    if as_json:
        print_json(found._asdict() | {"robots": [one._asdict() for one in found.robots]})
        return
    out = console()
    rows = [
        [
            one.robot,
            f"{one.bound} {failure_text(one.chance)}" if one.bound == "at least" else
            ", ".join(filter(None, (failure_text(one.chance), one.bound))),
            "–" if one.first is None else f"{one.first} ({percent_text(one.share)})" if one.share is not None else
            one.first,
            duration_text(one.remaining_life),
            one.state or "–",
            _as_of(one),
        ]
        for one in found.robots
    ]  # fmt: skip
    title = f"P(fails within {duration_text(found.horizon)}), of {count_text(found.of)} robots"
    columns = ("robot", "fails", "mostly by", "RUL, median", "state", "as of")
    print_table(out, table(title, columns, rows))
    if found.of > len(found.robots):
        out.print(more_text(found.of - len(found.robots), "listed"), markup=False)
    if found.unknown:
        out.print(f"Not known of {count_text(found.unknown)} more: they have sent no such figure", markup=False)


def _as_of(one: Risk) -> str:
    told = moment_text(one.time)
    return f"{told}; its clock is not believed" if abs(one.clock_ahead) > BELIEVED else told
