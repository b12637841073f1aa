"""``robophm fleet propose``: a design with the rates that a fleet has seen."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robophm.cli.shared.fleet import FleetStorePath
from robophm.cli.shared.learned import rate_json
from robophm.cli.shared.options import Design, Json, Prior
from robophm.cli.shared.output import print_json, warn
from robophm.cli.shared.proposed import print_proposal, proposal_json
from robophm.core.errors import DataError
from robophm.design.file import load
from robophm.design.robot import CLOCK_UNITS, Robot
from robophm.fleet.calibration import calibrate
from robophm.fleet.cohorts import compare
from robophm.fleet.experience import experience
from robophm.fleet.proposals import of_cohort, propose
from robophm.fleet.store import FleetStore
from robophm.learning.rates.rate_update import learn


def command(
    design: Design,
    store: FleetStorePath,
    prior: Prior = None,
    cohort: Annotated[
        str, typer.Option(help="learn of the robots of one cohort alone, such as site=Kiel", metavar="KIND=NAME")
    ] = "",
    as_json: Json = False,
) -> None:
    """Propose a design with the rates that the fleet has seen, with evidence, for a person to take."""
    robot = load(design)
    with FleetStore(store) as fleet:
        found, left_out = experience(fleet, [robot])
        differ = [one.to_json() for one in compare(found, prior).compared if one.real]
        own = of_cohort(found[0], cohort) if cohort else found[0]
        learned = learn(robot, own.seen, prior, each_robot=False)
        evidence = {
            "rates": [rate_json(one) | {"unit": CLOCK_UNITS[one.mode.clock]} for one in learned],
            "cohorts": differ, "robots": [one.robot for one in own.robots], "promises": _promises(fleet, robot),
        }  # fmt: skip
        made = propose(fleet, design, robot.name, cohort, learned, evidence)
    if as_json:
        print_json(proposal_json(made))
        return
    for name, why in left_out.items():
        warn(f"{name}: {why}; left out")
    print_proposal(made)


def _promises(fleet: FleetStore, robot: Robot) -> list[dict[str, Any]]:
    """What the design as it is has promised, site by site; nothing where no robot's figures tell."""
    try:
        return [one.to_json() for one in calibrate(fleet, [robot], "site").cohorts]
    except DataError:
        return []
