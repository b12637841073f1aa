"""When to replace which part: ``robophm.maintain``."""

from __future__ import annotations

import os

from robophm.core.argument_checks import number, path
from robophm.core.errors import DataError
from robophm.health.unknown_rates import few
from robophm.interface.asking import RobotOrPath, ledger_of, robot_of
from robophm.learning.maintenance.costs_table import read_costs
from robophm.learning.maintenance.upkeep import UpkeepPlan
from robophm.monitoring.monitor import Monitor
from robophm.stores import Address


def maintain(
    robot: RobotOrPath, costs: str | os.PathLike[str], store: Address | None = None, *, downtime_cost: float = 0.0,
    seed: int = 0,
) -> UpkeepPlan:  # fmt: skip
    """When each part whose costs a table states is best replaced, by its past in a store what is due.

    The plan is asked for visits at which several are replaced (``visit``), costs over years (``life_cycles``) and
    spares (``spares``). Raises DataError for costs that cannot be, or where no part of them has a rate.
    """
    found = robot_of(robot)
    hour_down = number(downtime_cost, "downtime_cost", error=DataError)
    seed = int(number(seed, "seed", whole=True, error=DataError))
    table = path(costs, "costs", DataError)
    stated = read_costs(table, found, hour_down)
    if all(one.part.unknown for one in stated.values()):
        raise DataError(f"{table}: all parts in it are of unknown rate ({few(list(stated))}); expected one with a rate")
    outlook = Monitor(found, ledger_of(store, found)).report(remaining_life=False).outlooks["sensor_based"]
    age = None if store is None else outlook.age
    return UpkeepPlan.of(found, stated, outlook.future.pace(outlook.plant), age=age, hour_down=hour_down, seed=seed)
