"""The best age to replace a part, by its cost before and after failure; alone, with repairs, or with others.

Times and lives are in one unit, costs in one currency; a cost rate is per that unit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

_GRID = 400
_FEW_OF_BEST = 1e-6  # of the cost of never replacing: what saves less is no reason to replace


@dataclass(frozen=True)
class Costs:
    """Costs of one part; those of an hour of standstill are included, or stated elsewhere."""

    preventive: float
    """Cost of replacing it before it fails."""
    corrective: float
    """Cost of replacing it after it failed."""
    preventive_downtime: float = 0.0
    corrective_downtime: float = 0.0
    """Time that it does not age meanwhile."""
    repair: float | None = None
    """Cost of a repair, which then takes the place of replacements after failures; None: it is not repaired."""
    remaining: float = 1.0
    """Share of its age that a repair leaves (Kijima II): 1, it only works again."""


@dataclass(frozen=True)
class Policy:
    """The best replacement policy of a part, and what it costs."""

    age: float | None
    """Age at which it is replaced; None: never by age."""
    cost_rate: float
    never: float
    """Cost rate of replacing, or repairing, only what has failed; infinite where repairs alone go on for ever."""

    @property
    def saving(self) -> float:
        """Return the share of the cost of never replacing by age that is saved."""
        return 1 - self.cost_rate / self.never if 0 < self.never < math.inf else 0.0


def hazard_rises(life: LifeDistribution) -> bool:
    """Whether the hazard ever rises: only then can replacing a part that works be worth anything."""
    ages = np.unique(np.asarray(life.quantile(np.linspace(0.001, 0.999, 200))))
    hazard = np.asarray(life.hazard(ages[ages > 0]))
    return bool(np.any(np.diff(hazard) > 1e-9 * hazard[:-1]))


def cost_rate(life: LifeDistribution, costs: Costs, age: npt.ArrayLike) -> Array:
    """Return the mean cost per unit of time of replacing at an age or at failure, as good as new; shape of ``age``.

    C(T) = (c_p·S + c_f·F)/(∫₀^T S dt + d_p·S + d_f·F), renewal reward (Barlow and Proschan 1965, §4.2).
    """
    T = np.asarray(age, dtype=float)
    failed = _failed(life, T)
    spent = costs.preventive * (1 - failed) + costs.corrective * failed
    lasts = _mean_up_to(life, T) + costs.preventive_downtime * (1 - failed) + costs.corrective_downtime * failed
    result: Array = spent / lasts
    return result


def best_age(life: LifeDistribution, costs: Costs, *, seed: int = 0) -> Policy:
    """Return the age at which replacing costs least; never by age, where that saves nothing."""
    if costs.repair is not None:
        return _with_repairs(life, costs, seed)
    never = costs.corrective / (mean_life(life) + costs.corrective_downtime)
    if not hazard_rises(life):
        return Policy(None, never, never)
    low, high = float(life.quantile(1e-9)), float(life.quantile(1 - 1e-9))
    age, cost = _least(lambda T: cost_rate(life, costs, T), max(low, 1e-9 * high), high)
    if not cost < never * (1 - _FEW_OF_BEST):
        return Policy(None, never, never)
    return Policy(age, cost, never)


def _least(cost: Callable[[Array], Array], low: float, high: float) -> tuple[float, float]:
    """The place and value of the least cost: on a logarithmic grid, then between its neighbours."""
    from scipy.optimize import minimize_scalar  # takes longer to load than most commands to answer

    grid = np.geomspace(low, high, _GRID)
    values = cost(grid)
    k = int(np.nanargmin(values))
    ends = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    found = minimize_scalar(
        lambda x: float(cost(np.array([math.exp(x)]))[0]), bounds=(math.log(ends[0]), math.log(ends[1])),
        method="bounded", options={"xatol": 1e-10},
    )  # fmt: skip
    if found.fun <= values[k]:
        return math.exp(found.x), float(found.fun)
    return float(grid[k]), float(values[k])


def _failed(life: LifeDistribution, T: Array) -> Array:
    """F of a part that begins at age 0, whatever mass its distribution has below."""
    return np.asarray(-np.expm1(-np.asarray(life.increment(np.zeros(np.shape(T)), T))))


def _mean_up_to(life: LifeDistribution, T: Array) -> Array:
    """∫₀^T S dt, by Gauss–Legendre over panels between quantiles."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    shares = np.array(
        [0, 1e-6, 1e-4, 1e-3, 1e-2, 0.05, 0.15, 0.3, 0.5, 0.7, 0.85, 0.95, 0.99, 0.999, 1 - 1e-6, 1 - 1e-10]
    )
    edges = np.maximum(np.asarray(life.quantile(shares)), 0.0)
    edges[0] = 0.0  # below a location all survive
    T = np.asarray(T, dtype=float)
    low = np.minimum(edges[:-1], T[..., None])
    high = np.minimum(np.append(edges[1:-1], np.inf), T[..., None])
    high = np.where(np.isfinite(high), high, low)
    times = low[..., None] + (high - low)[..., None] * (nodes + 1) / 2
    survives = np.exp(-np.asarray(life.increment(np.zeros(times.shape), times)))
    total: Array = ((high - low) / 2 * (survives @ weights)).sum(axis=-1)
    return total


def mean_life(life: LifeDistribution) -> float:
    """Return the mean life of a part that begins at age 0, whatever mass its distribution has below."""
    return life.mean() if life.lowest == 0 else float(_mean_up_to(life, np.array(np.inf)))


def _with_repairs(life: LifeDistribution, costs: Costs, seed: int) -> Policy:
    """C(T) = (c_p + c_r·N(T))/(T + downtimes), N the repairs by T; of minimal repair N = H."""
    repair = float(costs.repair or 0.0)
    scale = float(life.quantile(0.5))
    horizon = 20 * scale
    sooner = _repairs_by_simulation(life, costs.remaining, horizon, seed) if costs.remaining != 1 else None

    def repairs(T: Array) -> Array:
        return sooner(T) if sooner else np.asarray(life.increment(np.zeros(np.shape(T)), T))

    def cost(T: Array) -> Array:
        number = repairs(T)
        down = costs.preventive_downtime + costs.corrective_downtime * number
        return np.asarray((costs.preventive + repair * number) / (T + down))

    end = np.array([horizon / 2, horizon])
    number = repairs(end)
    late = float((number[1] - number[0]) / (end[1] - end[0]))
    never = repair * late / (1 + costs.corrective_downtime * late)
    if not hazard_rises(life):
        return Policy(None, never, never)
    if costs.remaining == 1:  # it only grows older
        never = math.inf
    age, least = _least(cost, scale * 1e-3, horizon)
    if age > 0.98 * horizon or not least < never * (1 - _FEW_OF_BEST):
        return Policy(None, never, never)
    return Policy(age, least, never)


def _repairs_by_simulation(
    life: LifeDistribution, remaining: float, horizon: float, seed: int, lives: int = 4000
) -> Callable[[Array], Array]:
    """Mean number of repairs by a time: V ← q·(V + X) at each (Kijima 1989, model II)."""
    rng = np.random.default_rng(seed)
    age, now = np.zeros(lives), np.zeros(lives)
    times: list[Array] = []
    for _ in range(100_000):
        going = now < horizon
        if not going.any():
            break
        start = age[going]
        before = np.asarray(life.increment(np.zeros(len(start)), start))
        end = np.maximum(np.asarray(life.age_at(_base(life) + before + rng.standard_exponential(len(start)))), start)
        now[going] += end - start
        age[going] = remaining * end
        times.append(now[going])
    every = np.sort(np.concatenate(times))
    return lambda T: np.searchsorted(every, T, side="right") / lives


def _base(life: LifeDistribution) -> float:
    return float(life.cumulative_hazard(0.0))


# -- several parts at one visit


@dataclass(frozen=True)
class Visit:
    """Parts that are replaced together: every how many visits each, and what all of it costs."""

    interval: float | None
    """Time between visits; None: nothing is worth a visit."""
    every: Mapping[str, int | None]
    """Number of visits, by part, after which it is replaced again; None: only when it has failed."""
    cost_rate: float
    apart: float
    """Cost rate where each part has visits of its own."""


def grouped_replacement(parts: Mapping[str, tuple[LifeDistribution, Costs]], setup: float) -> Visit:
    """Plan replacement at fixed intervals, where a visit costs ``setup`` whatever is done at it.

    Part i is replaced at every kᵢ-th visit and after each failure: cost rate s/τ + Σ min over k of
    (c_p + c_f·M(kτ))/(kτ), M the renewal function (block replacement, grouped indirectly: Goyal and Kusy,
    J. Oper. Res. Soc. 36, 1985).
    """
    blocks = {name: _Block(life, costs) for name, (life, costs) in parts.items()}
    apart = sum(block.alone(setup) for block in blocks.values())
    worth = [block for block in blocks.values() if block.best is not None]
    never = sum(block.never for block in blocks.values())
    if not worth:
        return Visit(None, dict.fromkeys(parts), never, apart)

    def cost(interval: float) -> float:
        return setup / interval + sum(block.at_best_multiple(interval)[0] for block in blocks.values())

    shortest = min(float(block.best or math.inf) for block in worth)
    grid = np.geomspace(shortest / 20, 4 * max(float(block.best or 0.0) for block in worth), 160)
    values = [cost(float(one)) for one in grid]
    k = int(np.argmin(values))
    fine = np.linspace(grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)], 60)
    candidates = [float(grid[k]), *(float(one) for one in fine)]
    interval = min(candidates, key=cost)
    least = cost(interval)
    if least >= never:
        return Visit(None, dict.fromkeys(parts), never, apart)
    return Visit(interval, {name: one.at_best_multiple(interval)[1] for name, one in blocks.items()}, least, apart)


class _Block:
    """A part replaced at fixed times and after each failure."""

    def __init__(self, life: LifeDistribution, costs: Costs) -> None:
        self.costs = costs
        self.never = costs.corrective / mean_life(life)
        self.best: float | None = None
        self.least = self.never
        if hazard_rises(life):
            self.times = np.linspace(0.0, float(life.quantile(0.999)), 1500)
            self.renewals = renewals(life, self.times)
            rates = self.rate(self.times[1:])
            k = int(np.argmin(rates))
            if rates[k] < self.never * (1 - _FEW_OF_BEST):
                self.best, self.least = float(self.times[1 + k]), float(rates[k])

    def rate(self, T: Array, more: float = 0.0) -> Array:
        """Cost rate of replacement at every T, each costing ``more`` besides."""
        failures = np.interp(T, self.times, self.renewals)
        result: Array = (self.costs.preventive + more + self.costs.corrective * failures) / T
        return result

    def alone(self, setup: float) -> float:
        """Least cost rate where each of its own visits costs ``setup``."""
        return min(self.never, float(self.rate(self.times[1:], setup).min())) if self.best is not None else self.never

    def at_best_multiple(self, interval: float) -> tuple[float, int | None]:
        """Least cost rate of being replaced at every k-th visit, and k; None: never by time."""
        if self.best is None or interval > self.times[-1]:
            return self.never, None
        most = int(min(self.times[-1] // interval, 200))
        rates = self.rate(np.array([interval * k for k in range(1, most + 1)]))
        k = int(np.argmin(rates))
        return (float(rates[k]), k + 1) if rates[k] < self.never else (self.never, None)


def renewals(life: LifeDistribution, times: Array) -> Array:
    """Mean number of failures by each of these times, equally far apart from 0, of a part renewed at each failure.

    M(t) = F(t) + ∫ M(t − x) dF(x), by the midpoints of M (Xie, Commun. Statist. Simul. 18, 1989).
    """
    F = _failed(life, times)
    half = _failed(life, times[:-1] + np.diff(times) / 2)
    M = np.zeros(len(times))
    first = 1 - half[0]
    for i in range(1, len(times)):
        # dM against F at midpoints: Σ F(tᵢ − tⱼ₋½)·(Mⱼ − Mⱼ₋₁)
        inner = half[i - 1 : 0 : -1] @ np.diff(M[:i]) if i > 1 else 0.0
        M[i] = (F[i] + inner - half[0] * M[i - 1]) / first
    return M
