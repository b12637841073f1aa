"""``robophm fleet calibrate``: what robots promised last month, against what was noted."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from robophm.cli.shared.fleet import Designs, FleetStorePath, known_kind
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json, print_table, table, warn
from robophm.design.file import load
from robophm.fleet.calibration import calibrate
from robophm.fleet.cohorts import KINDS
from robophm.fleet.store import FleetStore
from robophm.report.words import count_text, number_text


def command(
    designs: Designs,
    store: FleetStorePath,
    by: Annotated[str, typer.Option(help=f"cohorts: {', '.join(KINDS)}", metavar="KIND")] = "site",
    as_json: Json = False,
) -> None:
    """The failures that robots promised over their last thirty days, against those noted, by cohort."""
    known_kind(by)
    with FleetStore(store) as fleet:
        found = calibrate(fleet, [load(one) for one in designs], by)
    if as_json:
        print_json({
            "by": by, "robots": found.robots, "not_told": found.not_told,
            "together": asdict(found.together) | {"chance": found.together.chance},
            "cohorts": [one.to_json() for one in found.cohorts],
        })  # fmt: skip
        return
    for name, why in found.not_told.items():
        warn(f"{name}: {why}; not counted")
    out = console()
    rows = [
        [one.cohort, count_text(one.robots), number_text(one.counted.promised, 3), count_text(one.counted.noted),
         number_text(one.chance, 2), "does not hold" if one.rejected else "nothing against it"]
        for one in found.cohorts
    ]  # fmt: skip
    columns = (by, "robots", "failures promised", "noted", "chance", "what was promised")
    print_table(out, table("Promises of the last 30 days", columns, rows, figures=range(1, 5)))
    out.print(f"All robots together: {found.together.says}", markup=False, soft_wrap=True)
