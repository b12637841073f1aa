"""The uncertainty of a prognosis, its three sources told apart: chance itself, rates, and the load to come.

An uncertain rate speeds up the ageing of its failure mode: H(θ·u), one θ for all parts of one kind. Draws count by the
probability of what is known under them, survival to now above all. The load to come is drawn from the robot's own
history.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.waiting_time import Curve, time_at
from robophm.design.task import Task
from robophm.health.drawn_rates import draw_rates
from robophm.health.future import Future
from robophm.health.ledger import Ledger, Step
from robophm.health.mission import Completion, needed_now, needs, planned
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.weighted_draws import DrawnRates

Array = npt.NDArray[np.float64]

DRAWS = 2000
"""Draws of all rates together, unless said otherwise."""

SCENARIOS = 50
"""Scenarios of the load to come that are drawn."""

FEWEST_STEPS = 8
"""The fewest steps of the past from which the load to come is drawn."""

QUANTILES: Array = np.array([0.95, 0.5, 0.05])
"""The chances to still work at the three times of an interval."""

_AT_ONCE = 2_000_000  # numbers that one array may hold: more draws take turns
_IN_CACHE = 200_000  # numbers that work goes fast with

_QUICK = 200_000  # rates that are drawn where an answer is wanted at once
_FEW = 200  # draws that a first guess is made with
_STEPS_AHEAD = 64  # of a drawn load, which then begins anew


class Interval(NamedTuple):
    """A 90 % interval: the 5 %, 50 % and 95 % quantiles."""

    low: float
    median: float
    high: float


@dataclass(frozen=True)
class LifeUncertainty:
    """Remaining life [h of calendar time] with all that is not known, and with less of it."""

    all_sources: Interval
    """Interval where rates, load and chance are all uncertain."""
    rates_known: Interval
    load_known: Interval
    chance_alone: Interval
    """Interval with rates and load both known: what no knowledge of them could narrow."""

    @property
    def of_rates(self) -> bool:
        """Whether rates are uncertain, so that knowing them would change the interval."""
        return self.rates_known != self.all_sources

    @property
    def of_load(self) -> bool:
        """Whether the load to come is uncertain, so that knowing it would change the interval."""
        return self.load_known != self.all_sources


@dataclass(frozen=True)
class CompletionUncertainty:
    """The probability that a task fails or is completed, and the interval in which it may lie."""

    mean: Completion
    """Mean over all that is not known."""
    failure: Interval
    """Interval of the probability of failure, over rates and load."""
    failure_if_rates_known: Interval
    failure_if_load_known: Interval

    @property
    def of_rates(self) -> bool:
        """Whether rates are uncertain, so that knowing them would change the interval."""
        return self.failure_if_rates_known != self.failure

    @property
    def of_load(self) -> bool:
        """Whether the load to come is uncertain, so that knowing it would change the interval."""
        return self.failure_if_load_known != self.failure


def draw_loads(plant: Plant, ledger: Ledger, count: int, seed: int) -> list[Future]:
    """Draw loads to come in blocks from the robot's own past; none where that is too short.

    Blocks of √n steps keep what belongs together, such as day and night (Künsch 1989). Of all time the robot is to work
    the share that its design states, as in every other future: a past of one drive has none of its pauses.
    """
    steps = [step for step in ledger.history if step.calendar > 0]
    operating = sum(step.operating for step in steps)
    if len(steps) < FEWEST_STEPS or not operating > 0:
        return []
    longer = operating / (plant.robot.usage.operating * sum(step.calendar for step in steps))
    random = np.random.default_rng([seed, len(steps)])
    block = max(1, math.isqrt(len(steps)))
    count = max(2, min(count, _AT_ONCE * 4 // (_STEPS_AHEAD * len(plant.robot.modes))))
    return [_load(plant, steps, block, random, longer) for _ in range(count)]


def _load(plant: Plant, steps: Sequence[Step], block: int, random: np.random.Generator, longer: float) -> Future:
    """A load in which calendar time is so many times as long as it was."""
    starts = random.integers(0, len(steps), -(-_STEPS_AHEAD // block))
    drawn = [steps[(start + i) % len(steps)] for start in starts for i in range(block)]
    advance, effective = (np.column_stack([getattr(step, name) for step in drawn]) for name in ("age", "effective"))
    calendar, operating = [longer * step.calendar for step in drawn], [step.operating for step in drawn]
    if not sum(operating) > 0:
        return _load(plant, steps, block, random, longer)
    for of_clock in (advance, effective):
        of_clock[plant.calendar] *= longer
    return Future.of_steps("drawn from the past", calendar, operating, advance, effective)


def life_uncertainty(
    outlook: Outlook, diagram: Block, *, loads: Sequence[Future] = (), draws: int = DRAWS, seed: int = 0
) -> LifeUncertainty:
    """Return the remaining life of a system whose rates, and load to come, are not exactly known.

    ``loads``: equally likely futures; none: the outlook's own course is certain.
    """
    ratios = draw_rates(outlook.plant, draws, seed)
    exact = np.ones((len(ratios), max(len(loads), 1)))
    of = partial(predictive_life, outlook, diagram)
    if (ratios == 1).all():
        chance = of(exact[:, :1], [outlook.course])
        of_load = of(exact, loads) if loads else chance
        return LifeUncertainty(of_load, of_load, chance, chance)
    load_known, chance = of(ratios, [outlook.course]), of(exact[:, :1], [outlook.course])
    if not loads:
        return LifeUncertainty(load_known, chance, load_known, chance)
    return LifeUncertainty(of(ratios, loads), of(exact, loads), load_known, chance)


def completion_uncertainty(
    outlook: Outlook, task: Task, *, loads: Sequence[Future] = (), draws: int = DRAWS, seed: int = 0
) -> CompletionUncertainty:
    """Return the completion of a task where rates, and load that the task does not state, are not exactly known."""
    if not task.legs:
        return CompletionUncertainty(Completion(1.0, 0.0), *[Interval(0.0, 0.0, 0.0)] * 3)
    ratios = draw_rates(outlook.plant, draws, seed)
    own = [outlook.future]
    futures = [_mean_of_first(task.duration, load) for load in loads] or own
    found, weight = completions_of(outlook, task, ratios, futures)
    failure, probability = (float(weight @ one) for one in found)

    def interval(ratios: Array, futures: Sequence[Future]) -> Interval:
        (failures, _), weight = completions_of(outlook, task, ratios, futures)
        return weighted_interval(failures, weight)

    of_all = weighted_interval(found[0], weight)
    certain = bool((ratios == 1).all())
    return CompletionUncertainty(
        Completion(probability, failure),
        of_all,
        of_all if certain else interval(np.ones((len(ratios), len(futures))), futures),
        interval(ratios[:, :1] if certain else ratios, own) if loads else of_all,
    )


def failure_interval(
    outlook: Outlook, task: Task, *, loads: Sequence[Future] = (), draws: int = DRAWS, seed: int = 0
) -> Interval:
    """Return ``completion_uncertainty(…).failure`` alone, in a third of the time where rates and loads are drawn."""
    if not task.legs:
        return Interval(0.0, 0.0, 0.0)
    futures = [_mean_of_first(task.duration, load) for load in loads] or [outlook.future]
    found, weight = completions_of(outlook, task, draw_rates(outlook.plant, draws, seed), futures)
    return weighted_interval(found[0], weight)


def _mean_of_first(operating: float, load: Future) -> Future:
    """The mean of a load over its first hours of operation; of all of it for the clocks that stand meanwhile."""
    if not operating > 0:
        return load
    whole, rest = divmod(operating, float(load.operating[-1]))
    hours = whole * load.hours[-1] + np.interp(rest, load.operating, load.hours)
    begun = load.at(np.array([hours]))
    runs = begun[0] > 0
    ends = np.array([0.0, 1.0])
    advance, effective = (
        np.where(runs, one, hours / load.hours[-1] * total[:, -1:]) * ends
        for one, total in zip(begun, (load.advance, load.effective), strict=True)
    )
    return Future(load.name, hours * ends, operating * ends, advance, effective)


def completion_at_rates(outlook: Outlook, task: Task, ratio: float) -> Completion:
    """Return the completion of a task by a robot whose rates, its past too, are all ``ratio`` times the stated ones."""
    if not task.legs:
        return Completion(1.0, 0.0)
    (failure, probability), _ = completions_of(outlook, task, np.full((len(outlook.age), 1), ratio), [outlook.future])
    return Completion(float(probability[0]), float(failure[0]))


def completions_of(outlook: Outlook, task: Task, ratios: Array, futures: Sequence[Future]) -> tuple[Array, Array]:
    """The probabilities that a task fails and is completed under drawn rates, and the weight of each draw.

    Shapes (2, draws) and (draws,). ``ratios`` of shape (modes, draws): times the stated rates. Each draw has one of
    the futures.
    """
    wanted, ends = needs(task)
    mission = outlook.plant.mission(needed_now(wanted), wanted)

    def log_works(known: Array) -> Array:
        return mission.phases.log_known(known, np.zeros((len(ends), *known.shape)))

    drawn = DrawnRates(outlook, mission, mission.needed, ratios, len(futures), log_works)
    legs = [planned(replace(outlook, future=future), task) for future in futures]
    stated = [outlook.increments(drawn.scaling, *leg) for leg in legs]
    others = [
        outlook.increments(drawn.others, leg.advance[..., None], leg.effective[..., None], some)
        for leg, some in zip(legs, drawn.ratios, strict=True)
    ]
    groups = [
        replace(outlook, future=future).groups_steps(mission, leg.effective)
        for future, leg in zip(futures, legs, strict=True)
    ]
    more = np.add.reduceat(drawn.gathered(stated, others, groups), [0, *(end + 1 for end in ends[:-1])], axis=1)
    return np.stack(mission.phases.given(drawn.known, np.moveaxis(more, 1, 0))), drawn.weight


def life_with_rates_unsure(outlook: Outlook, diagram: Block, survives: Array) -> Array | None:
    """Return when survival falls to each of these chances [h], rates as uncertain as the design states them.

    None where every rate is exact. With the load that is expected, and fewer draws of many uncertain rates.
    """
    unsure = sum(mode.uncertainty is not None for mode in outlook.plant.robot.modes)
    if not unsure:
        return None
    draws = min(max(_QUICK // unsure, _FEW), DRAWS)
    return predictive_times(outlook, diagram, draw_rates(outlook.plant, draws, 0), [outlook.course], survives)


def predictive_life(outlook: Outlook, diagram: Block, ratios: Array, futures: Sequence[Future]) -> Interval:
    """Return quantiles of the remaining life [h] over draws of all rates (``draw_rates``), each with one future."""
    return Interval(*predictive_times(outlook, diagram, ratios, futures, QUANTILES).tolist())


def predictive_times(
    outlook: Outlook, diagram: Block, ratios: Array, futures: Sequence[Future], survives: Array
) -> Array:
    """Return when survival falls to each of these chances [h] over draws of all rates, each with one future."""
    system = outlook.plant.system(diagram)

    def curve_of(ratios: Array) -> Curve:
        drawn = DrawnRates(outlook, system, system.needed, ratios, len(futures), system.conditional.log_works)
        known = drawn.known[:, None]
        stated = [outlook.along(drawn.scaling, future) for future in futures]
        others = [outlook.along(drawn.others, *one) for one in zip(futures, drawn.ratios, strict=True)]
        groups = [outlook.groups_along(system, future) for future in futures]
        turn = max(1, _AT_ONCE // ratios.size)
        few = max(1, _IN_CACHE // (turn * len(known)))
        some = [slice(start, start + few) for start in range(0, ratios.shape[1], few)]
        draws = [(one, drawn.weight[one], system.conditional.given(known[..., one])) for one in some]

        def curve(hours: Array) -> tuple[Array, Array]:
            found = []
            scaled = [along(hours)[..., 0] for along in stated]
            dependent = [along(hours) for along in groups]
            for start in range(0, len(hours), turn):
                now = slice(start, start + turn)
                more = drawn.gathered(
                    [one[:, now] for one in scaled],
                    [along(hours[now]) for along in others],
                    [one[:, now] for one in dependent],
                )
                found.append(sum(np.stack(ahead(more[..., one])) @ weight for one, weight, ahead in draws))
            fails, survives = np.concatenate(found, axis=1)
            return fails, survives

        return curve

    if outlook.log_works(diagram) == -math.inf:
        return np.zeros(len(survives))
    guess = time_at(curve_of(ratios[:, :_FEW]), 1 - survives, survives, tolerance=1e-3)
    return _refined(curve_of(ratios), survives, guess)


def _refined(curve: Curve, survives: Array, guess: Array) -> Array:
    """The times at which a curve falls to these levels, by secants on the logarithm of its cumulative hazard.

    Where a secant leaves what the curve has shown, or the last came no nearer, as at a kink, the middle of it.
    """

    def level(x: Array) -> Array:
        fails, lives = curve(np.exp(x))
        with np.errstate(divide="ignore"):
            hazard: Array = np.log(np.where(fails < 0.5, -np.log1p(-fails), -np.log(lives)))
        return np.clip(hazard, -1e3, 1e3)

    found = guess.copy()
    todo = np.flatnonzero(np.isfinite(guess) & (guess > 0))
    if not len(todo):
        return found
    target = np.log(-np.log(survives[todo]))
    x, slope = np.log(guess[todo]), np.ones(len(todo))
    low, high = np.full(len(todo), -np.inf), np.full(len(todo), np.inf)
    y, slow = level(x), np.zeros(len(todo), dtype=bool)
    for _ in range(100):
        low, high = np.where(y <= target, np.maximum(x, low), low), np.where(y >= target, np.minimum(x, high), high)
        step = np.clip((target - y) / slope, -1.0, 1.0)
        near = np.abs(y - target) < 1e-5
        halve = ~near & np.isfinite(low) & np.isfinite(high) & (slow | (x + step < low) | (x + step > high))
        step[halve] = (low[halve] + high[halve]) / 2 - x[halve]
        if np.all(near | (high - low < 1e-12)):
            x = x + step
            break
        rise = level(x + step) - y
        slope = np.where(rise * step > 0, np.divide(rise, step, out=np.ones_like(step), where=step != 0), slope)
        slow = np.abs(y + rise - target) > np.abs(y - target) / 2
        x, y = x + step, y + rise
    found[todo] = np.exp(x)
    return found


def weighted_interval(values: Array, weight: Array) -> Interval:
    """The 5 %, 50 % and 95 % quantiles of values under weights; both of shape (draws,)."""
    order = np.argsort(values)
    level = np.cumsum(weight[order]) - weight[order] / 2
    return Interval(*(float(one) for one in np.interp([0.05, 0.5, 0.95], level, values[order])))
