"""``robophm cutsets``: the smallest sets of parts whose failure fails a robot, or whose work is enough."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.blocks.cut_sets import MinimalSets
from robophm.cli.shared.fault_trees import of_robot, print_sets, sets_json
from robophm.cli.shared.options import Design, Json, MostSets, Order
from robophm.cli.shared.output import console, print_json
from robophm.design.file import load
from robophm.report.minimal_sets import Listed
from robophm.report.words import probability_text


def command(
    design: Design,
    function: Annotated[str | None, typer.Option(help="of the robot; default the whole robot")] = None,
    order: Order = None,
    paths: Annotated[
        bool, typer.Option("--paths", help="what is enough to work, in place of what is enough to fail")
    ] = False,
    at: Annotated[
        float, typer.Option(help="operating hours of a new robot at which to state probabilities", min=0)
    ] = 1000.0,
    most: MostSets = 20,
    as_json: Json = False,
) -> None:
    """The smallest sets of parts whose failure fails a robot, the likeliest first."""
    system = of_robot(load(design), function, at)
    probability = float(system.tree.probability(system.occurred, system.not_yet))
    if paths and system.diagram is not None:
        sets = MinimalSets.paths(system.diagram)
        place = {name: i for i, name in enumerate(system.tree.names)}
        listed = Listed(sets, system.not_yet[[place[name] for name in sets.names]], most, order)
        share_of = 1.0 - probability
    else:
        listed, share_of = Listed(MinimalSets(system.tree), system.occurred, most, order), probability
    kind = "path" if paths else "cut"
    if as_json:
        print_json({"system": system.name, "when": system.when, "unreliability": probability,
                    f"{kind}_sets": sets_json(listed, share_of), **system.json})  # fmt: skip
        return
    out = console()
    has_failed = system.fails(probability_text(probability))
    out.print(f"{system.name}, {system.when}: has failed with {has_failed}", markup=False, soft_wrap=True)
    system.print_unknown()
    print_sets(listed, kind, share_of)
