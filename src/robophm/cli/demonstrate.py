"""``robophm demonstrate``: how many to test, for how long, so that few failures demonstrate a reliability."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Annotated

import typer

from robophm.cli.shared.options import Json, share_of, time_option
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.core.errors import RobophmError
from robophm.core.json_values import plain
from robophm.learning.life_data.demonstration import TestPlan, Wanted, demonstration, replaced_pass
from robophm.report.words import number_text, percent_text


def command(
    reliability: Annotated[
        str | None, typer.Option(help="reliability to demonstrate, e.g. 0.95 or '95 %'; with --at")
    ] = None,
    at: Annotated[float | None, time_option("--at", "time at which it must hold, e.g. '1000 h'", above=True)] = None,
    mtbf: Annotated[
        float | None,
        time_option("--mtbf", "MTBF to demonstrate at a constant rate, e.g. '5000 h', in place of both", above=True),
    ] = None,
    confidence: Annotated[str, typer.Option(help="confidence that a passed test gives")] = "90 %",
    allowed: Annotated[
        int, typer.Option(help="number of failures with which the test is still passed", min=0, max=10_000)
    ] = 0,
    shape: Annotated[float, typer.Option(help="shape β of the Weibull life; 1: constant rate, 2 to 4: wear")] = 1.0,
    units: Annotated[
        int | None, typer.Option(help="number of units to test; default: as few as possible", min=1)
    ] = None,
    duration: Annotated[
        float | None,
        time_option(
            "--duration",
            "duration of the test of each unit; default: as --at, or as short as --units allow",
            above=True,
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Plan a test that demonstrates a reliability: units, duration and allowed failures."""
    wanted = _wanted(reliability, at, mtbf, share_of("--confidence", confidence), allowed, shape)
    plan = demonstration(wanted, units, duration)
    if as_json:
        print_json({**plain(asdict(plan)), "total": plan.total})
    else:
        _show(plan, of_mean_life=mtbf is not None)


def _wanted(
    reliability: str | None, at: float | None, mtbf: float | None, confidence: float, allowed: int, shape: float
) -> Wanted:
    if mtbf is not None:
        if reliability is not None or at is not None:
            raise RobophmError(
                "--mtbf states what is wanted by itself; expected no --reliability and no --at beside it"
            )
        if shape != 1:
            raise RobophmError(f"--shape {shape:g}: a mean life is of a constant rate; expected --reliability and --at")
        return Wanted(math.exp(-1), mtbf, confidence, allowed)
    if reliability is None or at is None:
        raise RobophmError(
            "what is to be demonstrated? expected --reliability '95 %' --at '1000 h', or --mtbf '5000 h'"
        )
    return Wanted(share_of("--reliability", reliability), at, confidence, allowed, shape)


def _show(plan: TestPlan, *, of_mean_life: bool) -> None:
    out, wanted = console(), plan.wanted
    goal = f"a mean life of {_hours(wanted.at)}" if of_mean_life else (
        f"a reliability of {percent_text(wanted.reliability)} at {_hours(wanted.at)}"
    )  # fmt: skip
    most = f"at most {wanted.allowed:,} fail{'s' if wanted.allowed == 1 else ''}" if wanted.allowed else "none fails"
    out.print(f"Test {plan.units:,} for {_hours(plan.hours)} each, {_hours(plan.total)} of all together. If {most}, "
              f"{goal} is demonstrated with {percent_text(plan.confidence)} confidence", markup=False,
              soft_wrap=True)  # fmt: skip
    if wanted.shape != 1:
        out.print(f"by a Weibull life of shape {number_text(wanted.shape)}, which the test itself does not show",
                  markup=False, soft_wrap=True)  # fmt: skip
    together = plan.with_replacement
    if together:
        out.print(f"or, where failed ones are replaced at once, any number for {_hours(together)} of all "
                  "together", markup=False, soft_wrap=True)  # fmt: skip
    columns = ["lives truly are", "the test is passed with", *(["with replacement"] if together else [])]
    rows = []
    for times, passed in plan.passed:
        row = ["just as wanted" if times == 1 else f"{number_text(times)} times as long", percent_text(passed)]
        rows.append(row + ([percent_text(replaced_pass(wanted, together, times))] if together else []))
    print_table(out, table("", columns, rows, figures=range(1, len(columns))))


def _hours(hours: float) -> str:
    return f"{number_text(hours)} h"
