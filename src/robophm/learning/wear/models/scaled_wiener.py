"""A Wiener process with noise whose drift itself wanders, on other scales of time and wear: many at once, exactly.

On a scale z = g(wear), τ = tᵇ: dZ = M dτ + σ dW, dM = σ√q dB, and a reading is z + noise of the sensor. Level and drift
come from Kalman's filter, σ² is integrated out (Student's t), and ratios of noise and of the drift's wandering to σ are
a grid. That of ordinary drift is Whitmore and Schenkelberg's (Lifetime Data Anal. 3, 1997); a drift that wanders is
the adaptive one of Zhai and Ye (IEEE Trans. Ind. Inform. 13, 2017).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gammaln, stdtr

from robophm.learning.wear.models.candidates import (
    FAR,
    Array,
    DegradationPath,
    Indices,
    origin_of_surprise,
)  # fmt: skip

NOISE = np.array([1e-5, 1e-3, 1e-2, 1e-1, 1.0, 10.0, 1e3])
"""Variance of a reading over that of wandering in one reference time."""
WANDERING = np.array([0.0, 1.0, 10.0, 100.0])
"""Variance that the drift takes on in a reference time, over σ² per time."""
GRID = len(NOISE) * len(WANDERING)
_NOISE_PRIOR = 1 / np.sqrt(1 + NOISE)  # as in increment_covariance.py
_PRIOR = np.outer(_NOISE_PRIOR / _NOISE_PRIOR.sum(), np.full(len(WANDERING), 1 / len(WANDERING))).ravel()

_RESOLVED = 0.01  # of the wear so far: what wandering is taken for before anything is read, at the weight of 1 reading
STEPS = 80
FIRST = 3
"""Readings that a level and a drift are first known from; later ones are foretold."""


@dataclass(frozen=True)
class Scale:
    """A scale of wear and time, and how likely it is among its model's."""

    weight: float
    stretch: Callable[[Array], tuple[Array, Array]]
    """Function from wear to z and ln dz/dwear."""
    power: float = 1.0
    """Power of time that the scale runs by."""
    accelerates: int = 0


def as_it_is(wear: Array) -> tuple[Array, Array]:
    """The scale of wear itself."""
    return wear, np.zeros_like(wear)


def growing(gain: float, exponent: float) -> Callable[[Array], tuple[Array, Array]]:
    """The scale on which wear that grows by (1 + gain·wear)^exponent goes straight; below 0 it is wear itself."""

    def stretch(wear: Array) -> tuple[Array, Array]:
        base = np.maximum(1 + gain * np.maximum(wear, 0.0), 1e-9)
        power = 1 - exponent
        z = np.log(base) / gain if abs(power) < 1e-9 else (base**power - 1) / (gain * power)
        return np.where(wear > 0, z, wear), -exponent * np.log(base)

    return stretch


@dataclass(frozen=True)
class _States:
    """Behind each reading; shapes (readings, candidates), covariances over σ²."""

    level: Array
    drift: Array
    level_variance: Array
    covariance: Array
    drift_variance: Array
    squares: Array
    degrees: Array

    def at(self, k: int) -> _States:
        return _States(*(getattr(self, name)[k] for name in self.__dataclass_fields__))


class ScaledWiener:
    """Scales × ratios of noise × ratios of wandering, for one course."""

    def __init__(self, course: DegradationPath, scales: Sequence[Scale]) -> None:
        self.course, self.scales = course, scales
        each = [scale.stretch(course.wear)[0] for scale in scales]
        slopes = [scale.stretch(course.smooth)[1] for scale in scales]
        tau = [course.times**scale.power for scale in scales]
        self.z, self.slopes, self.tau = (np.repeat(np.column_stack(one), GRID, axis=1) for one in (each, slopes, tau))
        self.prior: Array = np.repeat([scale.weight for scale in scales], GRID) * np.tile(_PRIOR, len(scales))
        self.accelerates: Indices = np.repeat(np.array([scale.accelerates for scale in scales]), GRID)
        self.power: Array = np.repeat([scale.power for scale in scales], GRID)
        self.wandering: Array = np.tile(np.tile(WANDERING, len(NOISE)), len(scales))
        relative = np.exp(2 * (self.slopes - self.slopes.mean(axis=0)))
        self.noises: Array = np.tile(np.repeat(NOISE, len(WANDERING)), len(scales)) * relative
        self.states, self.one_step = self._filtered()

    @property
    def scores(self) -> Array:
        """Return the scores of what was foretold from each reading of the next."""
        result: Array = self.one_step[FIRST:].sum(axis=0)
        return result

    def _filtered(self) -> tuple[_States, Array]:
        z, n = self.z, len(self.z)
        none = np.zeros(z.shape[1])
        span = self.tau[-1] - self.tau[0]
        squares = (_RESOLVED * (np.abs(z[-1] - z[0]) + 0.1 * _RESOLVED)) ** 2 / span
        now = _States(z[0], none, self.noises[0], none, none + 1e8, squares, none + 1)
        kept, one_step = [now], np.zeros(z.shape)
        for k in range(1, n):
            now, one_step[k] = self._step(now, k, known=k > 1)
            kept.append(now)
        states = _States(*(np.stack([getattr(one, name) for one in kept]) for name in _States.__dataclass_fields__))
        return states, one_step + self.slopes

    def _step(self, now: _States, k: int, *, known: bool) -> tuple[_States, Array]:
        """The state after one reading, and the log density that the reading had; ``known``: there is a drift."""
        d, q, noise = self.tau[k] - self.tau[k - 1], self.wandering, self.noises[k]
        level, variance = now.level + now.drift * d, now.drift_variance + q * d
        covariance = now.covariance + d * now.drift_variance + q * d**2 / 2
        own = now.level_variance + 2 * d * now.covariance + d**2 * now.drift_variance + d + q * d**3 / 3
        off, spread = self.z[k] - level, own + noise
        density = np.zeros_like(off)
        squares, degrees = now.squares, now.degrees
        if known:
            density = log_student(off, spread * squares / degrees, degrees)
            squares, degrees = squares + off**2 / spread, degrees + 1
        to_level, to_drift = own / spread, covariance / spread
        after = _States(
            level + to_level * off,
            now.drift + to_drift * off,
            own * (1 - to_level),
            covariance * (1 - to_level),
            variance - to_drift * covariance,
            squares,
            degrees,
        )
        return after, density

    def _ahead(self, origin: int, later: Indices) -> tuple[Array, Array, Array]:
        """Off by how much readings are from what was foretold, its variance, degrees of freedom."""
        now = self.states.at(origin)
        h = self.tau[later] - self.tau[origin]
        spread = now.level_variance + 2 * h * now.covariance + h**2 * now.drift_variance + h
        spread = spread + self.wandering * h**3 / 3 + self.noises[later]
        return self.z[later] - now.level - now.drift * h, spread * now.squares / now.degrees, now.degrees

    def surprise(self) -> Array:
        """Return the two-sided probability of the last reading, by Student's t."""
        n = len(self.z)
        if n < FIRST + 5:
            return np.ones(self.z.shape[1])
        off, variance, degrees = self._ahead(origin_of_surprise(n), np.array([n - 1]))
        result: Array = 2 * stdtr(degrees, -np.abs(off[0]) / np.sqrt(variance[0]))
        return result

    def noise(self) -> Array:
        """Return the standard deviation of a reading on the scale of wear."""
        last = self.states.at(-1)
        result: Array = np.sqrt(last.squares / last.degrees * self.noises[-1]) * np.exp(-self.slopes[-1])
        return result

    def _drawn(self, which: Indices, rng: np.random.Generator) -> tuple[Array, Array, Array]:
        """Draws of level, drift and σ."""
        now = self.states.at(-1)
        sigma = np.sqrt(now.squares[which] / rng.chisquare(now.degrees[which]))
        a = np.sqrt(np.maximum(now.level_variance[which], 1e-300))
        b = now.covariance[which] / a
        c = np.sqrt(np.maximum(now.drift_variance[which] - b**2, 0.0))
        x, y = rng.standard_normal((2, len(which)))
        return now.level[which] + sigma * a * x, now.drift[which] + sigma * (b * x + c * y), sigma

    def speed(self, which: Indices, rng: np.random.Generator) -> Array:
        """Return the drift on the scale, brought back to wear and time."""
        _, drift, _ = self._drawn(which, rng)
        power, now = self.power[which], self.course.times[-1]
        result: Array = drift * power * now ** (power - 1) * np.exp(-self.slopes[-1][which])
        return result

    def passages(self, which: Indices, goals: Array, rng: np.random.Generator) -> Array:
        """Simulate passages in steps that lengthen; a Brownian bridge adds what is missed between two steps."""
        goal = np.empty(len(which))
        for k, scale in enumerate(self.scales):
            mine = which // GRID == k
            goal[mine] = scale.stretch(goals[mine])[0]
        level, drift, sigma = self._drawn(which, rng)
        ahead = np.concatenate(([0.0], np.geomspace(2e-4, FAR, STEPS)))
        wandering = sigma * np.sqrt(self.wandering[which])
        found = np.where(level < goal, np.inf, 0.0)
        tau = (self.course.times[-1] + ahead[:, None]) ** self.power[which]
        for k, d in enumerate(np.diff(tau, axis=0)):
            x, y, w = rng.standard_normal((3, len(which)))
            turned = wandering * np.sqrt(d) * y
            after = level + drift * d + sigma * np.sqrt(d) * x + d * (turned / 2 + wandering * np.sqrt(d / 12) * w)
            left, then = np.maximum(goal - level, 0.0), np.maximum(goal - after, 0.0)
            over = after >= goal
            met = over | (rng.random(len(which)) < np.exp(-2 * left * then / (sigma**2 * d)))
            share = np.where(over & (left > 0), left / np.maximum(after - level, 1e-9 * np.abs(goal) + 1e-300), 0.5)
            time = ahead[k] + share * (ahead[k + 1] - ahead[k])
            found = np.where(met & np.isinf(found), time, found)
            level, drift = after, drift + turned
        return found


def log_student(off: Array, variance: Array, degrees: Array) -> Array:
    """Log density of Student's t; shapes that broadcast."""
    constant = gammaln((degrees + 1) / 2) - gammaln(degrees / 2) - 0.5 * np.log(np.pi * degrees)
    result: Array = constant - 0.5 * np.log(variance) - (degrees + 1) / 2 * np.log1p(off**2 / (degrees * variance))
    return result
