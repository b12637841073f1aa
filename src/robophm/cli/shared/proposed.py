"""Proposals of a fleet as people and machines read them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.output import console, print_json
from robophm.fleet.proposals import Proposal, decide
from robophm.fleet.store import FleetStore
from robophm.report.words import moment_text, number_text

Number = Annotated[int, typer.Argument(help="number of the proposal", min=1, metavar="NUMBER")]
By = Annotated[str, typer.Option(help="the person who decides")]


def proposal_json(one: Proposal) -> dict[str, Any]:
    """Return a proposal with its evidence, its diff and what was decided."""
    decisions = [each._asdict() for each in one.decisions]
    return {**one._asdict(), "decisions": decisions, "state": one.state, "diff": one.diff}


def print_proposal(one: Proposal) -> None:
    """Print a proposal: the evidence of each rate, what was found of cohorts, the diff, and what was decided."""
    out = console()
    whom = f", of robots of {one.cohort}" if one.cohort else ""
    out.print(f"Proposal {one.number} for {one.design}{whom}, made {moment_text(one.time)}: {one.state}", markup=False)
    for rate in one.evidence["rates"]:
        out.print(
            f"{rate['mode']}: {number_text(rate['failures'])} failures where {number_text(rate['expected'], 3)} were "
            f"expected in {number_text(rate['exposure'])} {rate['unit']}; {number_text(rate['factor'], 3)} times the "
            f"stated rate, 90 % {number_text(rate['low'], 3)} … {number_text(rate['high'], 3)}; the stated one counts "
            f"as {number_text(rate['prior_failures'], 3)} failures, P(so far off by it) = "
            f"{number_text(rate['surprise'], 2)}", markup=False, soft_wrap=True,
        )  # fmt: skip
    for each in one.evidence["cohorts"]:
        out.print(
            f"{each['mode']}: {each['kind']} {each['cohort']} differs, {number_text(each['low'], 3)} … "
            f"{number_text(each['high'], 3)} times the others (p = {number_text(each['chance'], 2)}); one rate for all "
            "is wrong for it", style="yellow", markup=False, soft_wrap=True,
        )  # fmt: skip
    for each in one.evidence["promises"]:
        said = f"(p = {number_text(each['chance'], 2)}{', which does not hold' if each['rejected'] else ''})"
        out.print(
            f"Site {each['cohort']}: {number_text(each['promised'], 3)} failures promised in 30 days, "
            f"{each['noted']} noted {said}",
            style="yellow" if each["rejected"] else None, markup=False, soft_wrap=True,
        )  # fmt: skip
    out.print(one.diff, markup=False, soft_wrap=True)
    for decision in one.decisions:
        out.print(f"{moment_text(decision.time)}: {decision.decided} by {decision.person}", markup=False)


def decided(number: int, design: Path, store: FleetStorePath, by: str, what: str, *, as_json: bool) -> None:
    """Decide on a proposal, and say what was done."""
    with FleetStore(store) as fleet:
        done = decide(fleet, number, design, by, what)
    if as_json:
        print_json(proposal_json(done))
    else:
        console().print(f"Proposal {number} is {what} by {by}; {design} is what it says", markup=False, soft_wrap=True)
