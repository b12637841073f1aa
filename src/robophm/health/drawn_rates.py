"""Rates that are not exactly known, drawn."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import gammaincinv, ndtri

from robophm.core.spread import deviation_of
from robophm.design.robot import FailureMode, Robot, Uncertainty
from robophm.health.plant import Plant
from robophm.parts import graded

Array = npt.NDArray[np.float64]


def draw_rates(plant: Plant, count: int, seed: int) -> Array:
    """Ratio of each mode's rate to the stated one in so many draws; shape (modes, count), each row of mean 1.

    Each is drawn evenly from its distribution (McKay, Beckman and Conover 1979) and on its own: another part in the
    design changes nothing. What a common cause takes from a part has that part's rate; parts of one entry of the
    library have one (``state_of_knowledge``), and parts of one level share how good they are (``draw_qualities``).
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


def drawn_together(robot: Robot, mode: FailureMode) -> str:
    """A key of the rates that share any unknown: of one level of unknown quality, else of one state of knowledge."""
    quality = mode.uncertainty.quality if mode.uncertainty else None
    return f"quality of {quality.level}" if quality else state_of_knowledge(robot, mode)


def state_of_knowledge(robot: Robot, mode: FailureMode) -> str:
    """A key of the uncertainty of a rate: failure modes with equal keys share one unknown, and so one draw.

    An entry of the library says of a kind of part how often it fails. Where that is three times off, it is so for all
    parts of that entry, until the field has said something of one (state-of-knowledge correlation: Apostolakis and
    Kaplan, Reliability Engineering 2, 1981). So it is where one of them works more than another and has a
    higher rate as stated: what is shared is the factor by which the entry is off.
    """
    entry = graded(mode.source)
    if mode.evidence or not entry:
        return mode.origin
    name = mode.origin.removeprefix(robot.part_of(mode))  # of the mode in its part; "" where that has one alone
    return f"{entry} {mode.clock} {name}"


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
