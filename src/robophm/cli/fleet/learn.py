"""``robophm fleet learn``: what failures of all robots say of the rates of their designs."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from rich.console import Console

from robophm.cli.shared.fleet import Designs, FleetStorePath, known_kind
from robophm.cli.shared.learned import print_learned, rate_json, unstated_json
from robophm.cli.shared.options import Json, Prior
from robophm.cli.shared.output import console, print_json, print_table, table, warn
from robophm.design.file import load
from robophm.design.robot import CLOCK_UNITS
from robophm.fleet.cohorts import KINDS, CohortRate, Compared, Comparisons, cohort_rates, compare
from robophm.fleet.experience import Experience, experience
from robophm.fleet.store import FleetStore
from robophm.learning.rates.cohorts import FALSE_RATE, FEWEST_ROBOTS
from robophm.learning.rates.rate_update import LearnedRate, UnstatedRate, learn, unstated
from robophm.report.words import count_text, number_text, percent_text


def command(
    designs: Designs,
    store: FleetStorePath,
    prior: Prior = None,
    by: Annotated[
        str | None, typer.Option(help=f"list the rates of each cohort by {', '.join(KINDS)}", metavar="KIND")
    ] = None,
    as_json: Json = False,
) -> None:
    """Failure rates by what all robots of the fleet have gone through."""
    if by is not None:
        known_kind(by)
    loaded = [load(one) for one in designs]
    with FleetStore(store) as fleet:
        found = experience(fleet, loaded)
    learned = [
        (one, learn(one.design, one.seen, prior, each_robot=False), unstated(one.design, one.seen))
        for one in found.designs
    ]
    compared = compare(found.designs, prior)
    rates = [] if by is None else cohort_rates(found.designs, by, prior)
    if as_json:
        document: dict[str, Any] = {
            "designs": [_as_json(*one) for one in learned], "left_out": found.left_out,
            **compared._asdict(), "compared": [one.to_json() for one in compared.compared],
        }  # fmt: skip
        if by is not None:
            document |= {"by": by, "cohorts": [_rate_json(one) for one in rates]}
        print_json(document)
        return
    for name, why in found.left_out.items():
        warn(f"{name}: {why}; left out")
    out = console()
    for one in learned:
        if one[0].robots:
            _print(*one)
        else:
            warn(f"{one[0].design.name}: no robot of it has sent a ledger of its work")
    if by is not None:
        _print_rates(out, by, rates)
    _print_compared(out, compared)


def _as_json(found: Experience, learned: list[LearnedRate], unrated: list[UnstatedRate]) -> dict[str, Any]:
    return {
        "design": found.design.name, "robots": [one.robot for one in found.robots],
        "rates": [rate_json(one) for one in learned], "unknown": [unstated_json(one) for one in unrated],
    }  # fmt: skip


def _print(found: Experience, learned: list[LearnedRate], unrated: list[UnstatedRate]) -> None:
    number = len(found.robots)
    print_learned(f"{found.design.name}, {count_text(number)} robot{'s' * (number != 1)}", learned, unrated)


def _rate_json(one: CohortRate) -> dict[str, Any]:
    return {**one._asdict(), "learned": rate_json(one.learned)}


def _print_rates(out: Console, by: str, rates: list[CohortRate]) -> None:
    rows = []
    for design, cohort, robots, one in sorted(rates, key=lambda rate: (rate.learned.mode.path, rate.cohort)):
        unit, mean = CLOCK_UNITS[one.mode.clock], one.fleet.mean
        rows.append([
            one.mode.path, cohort if by == "design" or len({rate.design for rate in rates}) == 1 else
            f"{cohort} ({design})", count_text(robots), number_text(one.failures), number_text(one.expected, 3),
            f"{number_text(one.exposure)} {unit}", f"{number_text(one.stated * mean.times, 3)} /{unit}",
            f"{number_text(one.stated * mean.low, 3)} … {number_text(one.stated * mean.high, 3)}",
        ])  # fmt: skip
    columns = ("", by, "robots", "failures", "expected", "exposure", "learned rate", "90 % of their mean")
    print_table(out, table(f"By {by}", columns, rows, figures=range(2, len(columns))))


def _print_compared(out: Console, found: Comparisons) -> None:
    """Say which differences between cohorts are real, and of how many."""
    number = len(found.compared)
    if not number:
        if found.too_few:
            out.print("No cohorts were compared: there are too few robots in each, or outside it", markup=False)
        return
    rows = [
        [one.mode, f"{one.kind} {one.cohort}", count_text(one.robots), count_text(one.found.failures),
         number_text(one.found.others.expected, 3), _times(one), number_text(one.chance, 2)]
        for one in found.compared if one.real
    ]  # fmt: skip
    if rows:
        columns = ("", "cohort", "robots", "failures", "by the others", "times the others, 90 %", "chance")
        print_table(out, table("Cohorts that differ", columns, rows, figures=range(2, len(columns))))
    said = f"{len(rows) or 'none'} differ{'s' * (len(rows) == 1)} from the others by more than robots do anyway"
    out.print(f"Of {count_text(number)} cohorts' parts {said}; that any is said to where none does has a chance of "
              f"{percent_text(FALSE_RATE)} at most", markup=False, soft_wrap=True)  # fmt: skip
    if found.too_few:
        out.print(f"Not compared: {count_text(found.too_few)}, with fewer than {FEWEST_ROBOTS} robots that have worked "
                  "in them or outside", markup=False, soft_wrap=True)  # fmt: skip


def _times(one: Compared) -> str:
    low, high = one.found.times
    return f"{number_text(low, 3)} … {number_text(high, 3)}"
