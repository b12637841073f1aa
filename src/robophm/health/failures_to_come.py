"""The parts that failures within a stated horizon will come from, and the share of each."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.blocks.importance import barlow_proschan
from robophm.core.argument_checks import number
from robophm.core.waiting_time import LONGEST
from robophm.health.outlooks import View
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.health.worn import believed

Array = npt.NDArray[np.float64]

_TOLERANCE = 1e-6  # of a share


@dataclass(frozen=True)
class Contribution:
    """The share of a component, or of a group of dependent parts, in the failures to come."""

    path: str
    """Path of the component (all of its equal parts together), or name of the group."""
    quantity: int
    group: bool
    """Whether this is a group, which fails as one unit: its members have no share of their own."""
    nominal: float
    """P(its failure is the one that fails the robot within the horizon | the robot fails within it); not a number where
    the robot has failed or cannot fail."""
    sensor_based: float


@dataclass(frozen=True)
class FailuresToCome:
    """The failures to come of a robot, given what is known now; the shares of each view add up to 1."""

    horizon: float
    """The time from now on in which failures are looked for [h of calendar time]."""
    stated: bool
    """Whether the horizon was asked for; else it is the robot's sensor-based median remaining life."""
    operating: float
    """Hours of operation within it."""
    nominal_failure: float
    """P(the robot fails within the horizon)."""
    sensor_based_failure: float
    contributions: tuple[Contribution, ...]
    """The largest sensor-based share first; of parts of unknown rate, whose failures are not counted, none."""
    unknown: PartsOfUnknownRate | None = None
    """The parts of unknown rate that are left out, and what that makes of the figures."""


def failures_to_come(
    outlooks: Mapping[View, Outlook], diagram: Block, median: float, horizon: float | None = None
) -> FailuresToCome:
    """Return the failures to come within a horizon [h], or within the ``median`` remaining life if none is given.

    Exact through redundancy, shared parts, ageing and what is known: ∫ P(the robot hangs on a part) dP(it fails). Along
    a future that changes, at its mean pace. Raises RobophmError for what is no time ahead.
    """
    if horizon is not None:
        horizon = number(horizon, "horizon [h]", above=True, high=LONGEST)
    lived = outlooks["sensor_based"]
    ahead = min(median if horizon is None else horizon, LONGEST)
    course = lived.course
    share = float(course.operating[-1] / course.hours[-1])
    each = {view: _caused(outlook, diagram, ahead * share) for view, outlook in outlooks.items()}
    plant = lived.plant
    parts = [*((part.quantity, False) for part in plant.components), *((1, True) for _ in plant.groups)]
    shares = {view: caused / fails if fails > 0 else np.full(len(caused), math.nan)
              for view, (caused, fails) in each.items()}  # fmt: skip
    seen = believed(lived)
    rated = [not all(mode.unknown and mode.path not in seen for mode in part.modes) for part in plant.components]
    rated += [True] * len(plant.groups)
    drawn = [i for i in np.unique(plant.component_of[plant.system(diagram).units]).tolist() if rated[i]]
    order = sorted(drawn, key=lambda i: -np.nan_to_num(shares["sensor_based"][i]))
    return FailuresToCome(
        ahead, horizon is not None, ahead * share, each["nominal"][1], each["sensor_based"][1],
        tuple(Contribution(plant.paths[i], *parts[i], *(float(shares[view][i]) for view in ("nominal", "sensor_based")))
              for i in order),
        unknown(lived, diagram),
    )  # fmt: skip


def _caused(outlook: Outlook, diagram: Block, hours: float) -> tuple[Array, float]:
    """P(a component's failure is the one that fails the system within operating hours | what is known), and their sum.

    Components and groups in the plant's order. Parts in series are folded to one unit first, since each of them has of
    its failures what it has of its hazard: the work grows with the parts, not with their square.
    """
    if outlook.plan:
        outlook = replace(outlook, future=outlook.plan, plan=None)
    plant = outlook.plant
    system = plant.system(diagram)
    components = plant.component_of[system.units]
    known = system.of_groups(outlook.known(system, system.needed))[:, None]
    if np.isneginf(system.conditional.log_works(known)).any():
        return np.full(len(plant.paths), math.nan), 1.0

    def added(times: Array) -> tuple[Array, Array, Array]:
        advance, effective = outlook.paced(times)
        more = outlook.gathered(system, advance[:, None], effective[:, None])[:, 0]
        return system.of_groups(more), advance, effective

    def rates(times: Array) -> Array:
        more, advance, effective = added(times)
        hangs = system.conditional.hangs(known, more)
        return np.asarray(outlook.hazard_then(system, advance, effective) * hangs[system.group_of])

    def curve(times: Array) -> tuple[Array, Array]:
        return system.conditional.ahead(known, added(times)[0])

    of_units = barlow_proschan(rates, curve, hours, _TOLERANCE)
    caused = np.bincount(components, of_units, len(plant.paths)).astype(float)
    return caused, float(caused.sum())
