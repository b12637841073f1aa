"""Ranges of a robot's figures while its rates are not exactly known, and whose rate it would help most to know.

Unlike importance, which asks what fails a robot, this asks what nobody knows: a part with an uncertain rate is taken to
be known, at its stated rate, and what that makes of the ranges is how much knowing it would tell. In the words of
sensitivity analysis it is factor fixing, by the width of the range of the outcome.
Source: Saltelli and others, Global Sensitivity Analysis: The Primer (2008), section 1.2.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.design.robot import Component
from robophm.design.task import Leg, Task
from robophm.health.drawn_rates import draw_qualities, draw_rates, handbook_of
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import (
    DRAWS,
    Interval,
    completions_of,
    predictive_life,
    weighted_interval,
)
from robophm.health.weighted_draws import DrawnRates
from robophm.parts import graded

Array = npt.NDArray[np.float64]

NEXT = 1.0
"""Hours of operation over which the hazard rate is stated."""

MOST_TRIED = 40
"""Parts, or kinds of them, that are taken to be known in turn: of more, those that go most with the outcome."""

_TIMES = 48  # at which survival is asked in every draw


@dataclass(frozen=True)
class Ranges:
    """Intervals of a robot's figures that come of its uncertain rates: 5 %, 50 % and 95 % quantiles."""

    hazard_rate: Interval
    """The hazard rate over the next hour of operation [1/h]."""
    median_life: Interval
    """The median remaining life [h of calendar time]."""
    remaining_life: Interval
    """The remaining life itself, chance and all [h of calendar time]."""
    failure: Interval
    """The probability that the task is not completed."""

    def as_wide_as(self, other: Ranges) -> float:
        """How wide these ranges are, as a share of others: of median life and failure, the mean of both logarithms."""
        shares = []
        for mine, theirs in ((self.median_life, other.median_life), (self.failure, other.failure)):
            if (width := _width(theirs)) > 0:
                shares.append(_width(mine) / width)
        return sum(shares) / len(shares) if shares else 1.0


@dataclass(frozen=True)
class LargestUnknown:
    """Parts whose rate is not exactly known, and what knowing it would make of the ranges."""

    parts: tuple[Component, ...]
    """Several where they are of one entry of the library or one handbook's model: who learns of one learns of all."""
    entry: str
    """The entry of the library of parts, with its grade; "" where the rate is from elsewhere."""
    model: str
    """The name of the handbook's model where there is no entry; "" where the rate is from elsewhere."""
    quality_of: str | None
    """The path of the level whose quality alone would be known; None where the rate itself would be."""
    if_known: Ranges
    left: float
    """How wide the ranges would still be, as a share of what they are."""


def ranges(outlook: Outlook, diagram: Block, task: Task, *, draws: int = DRAWS, seed: int = 0) -> Ranges:
    """The figures of a system under its uncertain rates."""
    return _ranges(outlook, diagram, task, draw_rates(outlook.plant, draws, seed), chance=True)


def largest_unknowns(
    outlook: Outlook, diagram: Block, task: Task, *, most: int = 3, draws: int = DRAWS, seed: int = 0
) -> list[LargestUnknown]:
    """The parts whose rates it would help most to know, the first most; none where all are exact.

    Ranges of the remaining life are left as they are: chance makes most of them.
    """
    plant = outlook.plant
    ratios = draw_rates(plant, draws, seed)
    now = _ranges(outlook, diagram, task, ratios)
    unsure = _unsure(outlook, ratios)
    if len(unsure) > MOST_TRIED:
        told = _told(outlook, task, ratios)
        first = sorted(unsure, key=lambda key: -float(sum(told[row] for row in unsure[key])))[:MOST_TRIED]
        unsure = {key: unsure[key] for key in first}
    found: list[tuple[list[int], _Origin, str | None, Array]] = []
    qualities = draw_qualities(plant, draws, seed)
    for origin, rows in unsure.items():
        known = ratios.copy()
        known[rows] = 1.0
        found.append((rows, origin, None, known))
    for board, rows in _unknown_qualities(plant).items():
        known = ratios.copy()
        known[rows] /= qualities[rows]
        found.append((rows, _Origin(), board, known))
    narrowed = []
    for rows, origin, level, known in found:
        if_known = _ranges(outlook, diagram, task, known)
        parts = tuple(plant.components[i] for i in dict.fromkeys(plant.part[rows].tolist()))
        narrowed.append(LargestUnknown(parts, origin.entry, origin.model, level, if_known, if_known.as_wide_as(now)))
    return sorted((one for one in narrowed if one.left < 1.0), key=lambda one: one.left)[:most]


class _Origin(NamedTuple):
    """Where a rate is from: an entry of the library, else a handbook's model, else the part itself."""

    entry: str = ""
    model: str = ""
    part: int = -1


def _unsure(outlook: Outlook, ratios: Array) -> dict[_Origin, list[int]]:
    """The failure modes whose rates are not exact, by what they share; what the field has spoken of by its part."""
    plant = outlook.plant
    found = defaultdict(list)
    for row in np.flatnonzero(np.ptp(ratios, axis=1) > 0).tolist():
        mode, part = plant.robot.modes[row], int(plant.part[row])
        origin = _Origin(part=part)
        if not mode.evidence and (entry := graded(mode.source)):
            origin = _Origin(entry=entry)
        elif not mode.evidence and (model := handbook_of(mode)):
            origin = _Origin(model=model)
        found[origin].append(row)
    return found


def _unknown_qualities(plant: Plant) -> dict[str, list[int]]:
    """The failure modes by the level whose quality is unknown."""
    found = defaultdict(list)
    for row, mode in enumerate(plant.robot.modes):
        if mode.uncertainty and mode.uncertainty.quality:
            found[mode.uncertainty.quality.level].append(row)
    return found


def _ranges(outlook: Outlook, diagram: Block, task: Task, ratios: Array, *, chance: bool = False) -> Ranges:
    (soon, _), weight = completions_of(outlook, Task((Leg(NEXT),)), ratios, [outlook.future])
    (failure, _), same = completions_of(outlook, task, ratios, [outlook.future])
    rate = weighted_interval(soon, weight)
    life = predictive_life(outlook, diagram, ratios, [outlook.course]) if chance else Interval(*[math.nan] * 3)
    return Ranges(
        Interval(*(-math.log1p(-one) / NEXT if one < 1 else math.inf for one in rate)),
        _median_life(outlook, diagram, ratios),
        life,
        weighted_interval(failure, same),
    )


def _median_life(outlook: Outlook, diagram: Block, ratios: Array) -> Interval:
    """Over draws of all rates, the median of the remaining life in each, found between times that all draws share."""
    system, course = outlook.plant.system(diagram), outlook.course
    stated = outlook.remaining_life(diagram)
    if not 0 < stated.median < math.inf:
        return Interval(*[stated.median] * 3)
    drawn = DrawnRates(outlook, system, system.needed, ratios, 1, system.conditional.log_works)
    hours = np.geomspace(stated.median / 1e3, stated.median * 1e3, _TIMES)
    more = drawn.gathered(
        [outlook.along(drawn.scaling, course)(hours)[..., 0]],
        [outlook.along(drawn.others, course, drawn.ratios[0])(hours)],
        [outlook.groups_along(system, course)(hours)],
    )
    _, survives = system.conditional.given(drawn.known[:, None])(more)
    with np.errstate(divide="ignore"):
        hazard = np.log(np.maximum(-np.log(survives), 1e-300))
    level, steps = math.log(math.log(2.0)), np.log(hours)
    lives = np.array([np.interp(level, one, steps) for one in hazard.T])
    return weighted_interval(np.exp(lives), drawn.weight)


def _told(outlook: Outlook, task: Task, ratios: Array) -> Array:
    """How much each rate goes with the chance to fail a task: the square of their correlation over the draws."""
    (failure, _), _ = completions_of(outlook, task, ratios, [outlook.future])
    apart = np.log(np.maximum(failure, 1e-300))
    apart = apart - apart.mean()
    rates = np.log(np.maximum(ratios, 1e-300))
    rates = rates - rates.mean(axis=1, keepdims=True)
    both = (rates**2).sum(axis=1) * (apart**2).sum()
    found: Array = np.divide((rates @ apart) ** 2, both, out=np.zeros_like(both), where=both > 0)
    return found


def _width(interval: Interval) -> float:
    """Of a range, how many times as much its end is as its begin, as a logarithm."""
    low, _, high = interval
    return math.log(high / low) if 0 < low < high < math.inf else 0.0
