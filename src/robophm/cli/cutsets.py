"""``robophm cutsets``: the smallest sets of parts whose failure fails a robot, or whose work is enough."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.fault_trees import (
    of_robot,
    print_estimate,
    print_sets,
    print_unknown,
    sets_json,
    unknown_json,
)
from robophm.cli.shared.options import Design, Json, Limit, MostSets, Order, time_option
from robophm.cli.shared.output import console, print_json
from robophm.cli.shared.unused import refuse_unused
from robophm.design.file import load
from robophm.report.fault_trees import answer_json, answer_text, estimated
from robophm.report.words import probability_text


def command(
    design: Design,
    function: Annotated[str | None, typer.Option(help="function of the robot; default: the whole robot")] = None,
    order: Order = None,
    paths: Annotated[
        bool,
        typer.Option("--paths", help="minimal path sets, enough to work, in place of minimal cut sets, enough to fail"),
    ] = False,
    at: Annotated[
        float, time_option("--at", "time of operation, from new, at which probabilities are stated")
    ] = 1000.0,
    most: MostSets = 20,
    limit: Limit = 60.0,
    as_json: Json = False,
) -> None:
    """Minimal cut sets: the smallest sets of parts whose failure fails a robot, the likeliest first."""
    system = of_robot(load(design), function, at)
    if paths:
        refuse_unused("path sets, of which all are found", ("design", "function", "order", "paths", "at", "most"))
        listed = system.event.path_sets(most, order)
    kind, answer = "path" if paths else "cut", system.event.within(limit)
    by_chance = estimated(system.event, answer)
    if not paths:
        listed = answer.cut_sets(most, order)
    if as_json:
        document = answer_json(answer, by_chance)
        document["unreliability"] = document.pop("probability")
        print_json({"system": system.name, "when": system.when, **document,
                    f"{kind}_sets": sets_json(listed), **unknown_json(system)})  # fmt: skip
        return
    out = console()
    has_failed = system.fails(probability_text(answer.chance.low) if answer.exact else answer_text(answer))
    out.print(f"{system.name}, {system.when}: has failed with {has_failed}", markup=False, soft_wrap=True)
    print_estimate(by_chance)
    print_unknown(system)
    print_sets(listed, f"minimal {kind} set")
