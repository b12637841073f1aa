"""``robophm fleet proposals``: what a fleet proposed, and what was decided."""

from __future__ import annotations

from typing import Annotated

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.proposed import print_proposal, proposal_json
from robophm.fleet.proposals import proposal, proposals
from robophm.fleet.store import FleetStore
from robophm.report.words import moment_text


def command(
    store: FleetStorePath,
    number: Annotated[
        int | None, typer.Argument(help="one proposal, with its evidence", min=1, metavar="NUMBER")
    ] = None,
    as_json: Json = False,
) -> None:
    """The designs that were proposed, and what was decided; or one of them with its evidence."""
    with FleetStore(store) as fleet:
        found = proposals(fleet) if number is None else [proposal(fleet, number)]
    if as_json:
        print_json({"proposals": [proposal_json(one) for one in found]})
    elif number is not None:
        print_proposal(found[0])
    else:
        rows = [
            [str(one.number), one.design, one.cohort or "all", moment_text(one.time), one.state,
             one.decisions[-1].person if one.decisions else "–"]
            for one in found
        ]  # fmt: skip
        print_table(console(), table("Proposals", ("", "design", "learned of", "made", "state", "by"), rows))
