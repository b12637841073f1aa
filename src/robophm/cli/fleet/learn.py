"""``robophm fleet learn``: what failures of all robots say of the rates of their designs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.learned import rate_json, unstated_json
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table, warn
from robophm.design.file import load
from robophm.fleet.experience import Experience, experience
from robophm.fleet.store import FleetStore
from robophm.learning.rates.rate_update import LearnedRate, UnstatedRate, learn, unstated
from robophm.report.learned_rates import contradictions, learned_rows, unstated_text
from robophm.report.words import count_text


def command(
    designs: Annotated[list[Path], typer.Argument(help="design files of the robots", metavar="ROBOT.YAML…")],
    store: FleetStorePath,
    prior: Annotated[
        str | None,
        typer.Option(help="weight of the stated rates: '10000 h', '2 failures'; default: the design's, or 1"),
    ] = None,
    as_json: Json = False,
) -> None:
    """Failure rates by what all robots of the fleet have gone through."""
    loaded = [load(one) for one in designs]
    with FleetStore(store) as fleet:
        found = experience(fleet, loaded)
    learned = [(one, learn(one.design, one.seen, prior), unstated(one.design, one.seen)) for one in found.designs]
    if as_json:
        print_json({"designs": [_as_json(*one) for one in learned], "left_out": found.left_out})
        return
    for name, why in found.left_out.items():
        warn(f"{name}: {why}; left out")
    out = console()
    for one in learned:
        if one[0].robots:
            _print(out, *one)
        else:
            warn(f"{one[0].design.name}: no robot of it has sent a ledger of its work")


def _as_json(found: Experience, learned: list[LearnedRate], unrated: list[UnstatedRate]) -> dict[str, Any]:
    return {
        "design": found.design.name, "robots": [one.robot for one in found.robots],
        "rates": [rate_json(one) for one in learned], "unknown": [unstated_json(one) for one in unrated],
    }  # fmt: skip


def _print(out: Console, found: Experience, learned: list[LearnedRate], unrated: list[UnstatedRate]) -> None:
    columns, rows = learned_rows(learned, unrated)
    number = len(found.robots)
    title = f"What the field says of {found.design.name}, {count_text(number)} robot{'s' * (number != 1)}"
    print_table(out, table(title, columns, rows, figures=range(1, len(columns))))
    for words in contradictions(learned):
        out.print(words, style="yellow" if words.startswith("* ") else None, markup=False, soft_wrap=True)
    for other in unrated:
        out.print(unstated_text(other), style="yellow", markup=False, soft_wrap=True)
    out.print("expected: failures by the stated rate; times: learned over stated.", markup=False)
