"""``robophm allocate``: which parts a robot should have more of, for a budget or for a wanted reliability."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from robophm.cli.shared.options import Design, Json, share_of, time_option
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.core.json_values import plain
from robophm.design.file import load
from robophm.health.redundancy import allocation
from robophm.interface.redundancy import read_offers
from robophm.report.words import number_text, percent_text


def command(
    design: Design,
    offers: Annotated[
        Path, typer.Argument(help="a table: part, cost of one more, largest number to add", metavar="OFFERS.CSV")
    ],
    budget: Annotated[
        float | None, typer.Option(help="budget, in the unit of the costs: money, mass, power", min=0)
    ] = None,
    reliability: Annotated[
        str | None, typer.Option(help="wanted reliability, in place of a budget, e.g. '99.9 %'")
    ] = None,
    at: Annotated[
        float, time_option("--at", "time of operation, from new, until which it must work", above=True)
    ] = 1000.0,
    function: Annotated[str | None, typer.Option(help="function of the robot; default: the whole robot")] = None,
    limit: Annotated[float, typer.Option(help="seconds after which the best found so far is given", min=0.1)] = 30.0,
    as_json: Json = False,
) -> None:
    """Choose redundant parts for a budget, or for a wanted reliability."""
    robot = load(design)
    wanted = None if reliability is None else share_of("--reliability", reliability)
    found = allocation(
        robot, read_offers(offers), at, budget=budget, reliability=wanted, function=function, limit=limit
    )
    if as_json:
        print_json(plain(asdict(found)))
        return
    out = console()
    name = f"{robot.name}: {function}" if function else robot.name
    now, then = (percent_text(1 - failure, failure) for failure in (found.failure_now, found.failure))
    out.print(f"{name}, new, works until {number_text(at)} h with {now} as it is, and with {then} with these, for "
              f"{number_text(found.cost)}:", markup=False, soft_wrap=True)  # fmt: skip
    if found.more:
        print_table(out, table("", ["part", "more"], [[part, f"{n:,}"] for part, n in found.more.items()], figures=[1]))
    else:
        out.print("none: nothing on offer is needed, or can be had for the budget")
    if found.best:
        out.print("proved: no other choice is better")
    else:
        bound = f"costs less than {number_text(found.bound)}" if reliability else (
            f"works with more than {percent_text(1 - found.bound, found.bound)}"
        )  # fmt: skip
        out.print(f"the best found within {limit:g} s; none {bound}", style="yellow", markup=False, soft_wrap=True)
