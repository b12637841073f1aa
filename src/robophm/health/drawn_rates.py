"""Rates that are not exactly known, drawn."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.special import gammaincinv, ndtri

from robophm.core.spread import deviation_of
from robophm.design.robot import FailureMode, Robot, Uncertainty
from robophm.health.plant import Plant
from robophm.parts import graded

Array = npt.NDArray[np.float64]


def draw_rates(plant: Plant, count: int, seed: int) -> Array:
    """Ratio of each mode's rate to the stated one in so many draws; shape (modes, count), each row of mean 1.

    Each unknown is drawn evenly from its distribution (McKay, Beckman and Conover 1979) and on its own: another part in
    the design changes nothing. What a common cause takes from a part has that part's rate; parts of one handbook's
    model or entry of the library share one unknown (``state_of_knowledge``), and parts of one level how good they are
    (``draw_qualities``).
    """
    ratios = draw_qualities(plant, count, seed)
    for i, mode in enumerate(plant.robot.modes):
        if mode.uncertainty:
            level = _levels(state_of_knowledge(plant.robot, mode), count, seed)
            ratios[i] *= _ratio(mode.uncertainty, level)
    return ratios


def draw_qualities(plant: Plant, count: int, seed: int) -> Array:
    """Return the factors that unknown qualities make of each mode's rate; shape (modes, count), each row of mean 1.

    A board is bought as a whole: in one draw all its parts are as near to the best as they may be.
    """
    ratios = np.ones((len(plant.robot.modes), count))
    boards: dict[str, Array] = {}
    for i, mode in enumerate(plant.robot.modes):
        if mode.uncertainty and (quality := mode.uncertainty.quality):
            if quality.level not in boards:
                boards[quality.level] = _levels(f"quality of {quality.level}", count, seed)
            ratios[i] = _lognormal(quality.error_factor, boards[quality.level])
    return ratios


def _levels(key: str, count: int, seed: int) -> Array:
    """Evenly drawn probabilities of one unknown, in an order of its own."""
    random = np.random.default_rng([seed, *key.encode()])
    drawn: Array = (random.permutation(count) + random.random(count)) / count
    return drawn


def drawn_together(robot: Robot, modes: Sequence[int]) -> list[list[int]]:
    """Places in a list of uncertain modes, by the unknowns that they share, directly or through others."""
    from scipy.sparse.csgraph import connected_components  # takes a fifteenth of a second to load

    unknowns: dict[str, int] = {}
    pairs = []
    for place, i in enumerate(modes):
        mode, keys = robot.modes[i], [f"mode {i}"]
        if (unsure := mode.uncertainty) and replace(unsure, quality=None) != Uncertainty():
            keys.append(state_of_knowledge(robot, mode))
        if unsure and unsure.quality:
            keys.append(f"quality of {unsure.quality.level}")
        pairs += [(place, len(modes) + unknowns.setdefault(key, len(unknowns))) for key in keys]
    size = len(modes) + len(unknowns)
    shared = coo_array((np.ones(len(pairs)), np.array(pairs).T.reshape(2, -1)), (size, size))
    _, label = connected_components(shared, directed=False)
    found = defaultdict(list)
    for place in range(len(modes)):
        found[label[place]].append(place)
    return list(found.values())


def state_of_knowledge(robot: Robot, mode: FailureMode) -> str:
    """A key of the uncertainty of a rate: failure modes with equal keys share one unknown, and so one draw.

    A handbook's model, and an entry of the library, say of a kind of part how often it fails. Where that is three times
    off, it is so for all parts of that kind, until the field has said something of one (state-of-knowledge correlation:
    Apostolakis and Kaplan, Reliability Engineering 2, 1981). So it is where one of them works more than another and has
    a higher rate as stated: what is shared is the factor by which model or entry is off. A figure of a part's own
    is off by itself.
    """
    if mode.evidence:
        return mode.origin
    if model := handbook_of(mode):
        return model
    if entry := graded(mode.source):
        name = mode.origin.removeprefix(robot.part_of(mode))  # of the mode in its part; "" where that has one alone
        return f"{entry} {mode.clock} {name}"
    return mode.origin


def handbook_of(mode: FailureMode) -> str:
    """The name of the handbook's model that a rate is computed by; "" where it is stated, or by an own equation."""
    model = mode.stresses[0].model if mode.stresses else None
    return model.name if model and model.unit and model.source.printed else ""


def _ratio(uncertainty: Uncertainty, level: Array) -> Array:
    """The quantiles at these levels, but for what an unknown quality makes of it."""
    if uncertainty.error_factor is not None:
        return _lognormal(uncertainty.error_factor, level)
    result: Array = np.ones_like(level)
    if uncertainty.failures is not None:
        result = gammaincinv(uncertainty.failures, level) / uncertainty.failures
    elif uncertainty.samples is not None:
        samples = np.array(uncertainty.samples)
        result = samples[(level * len(samples)).astype(int)]
    return result


def _lognormal(error_factor: float, level: Array) -> Array:
    deviation = deviation_of(error_factor)
    result: Array = np.exp(deviation * ndtri(level) - deviation**2 / 2)
    return result
