"""The interface of every life distribution. Symbols: H cumulative hazard, h hazard, S survival = exp(−H).

Ages and durations are in the unit of the clock on which a failure mode ages (h, km, cycles, starts), hazards
per that unit. Every method takes scalars or arrays, broadcasts them, and returns what NumPy makes of them.

A distribution is a frozen dataclass of its parameters that writes H, h and the inverse of H; all else
follows (where lives reach below the location, its mean and deviation do not). It writes them of
x = age − location, and x is never below ``lowest``.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from numbers import Real
from typing import Any, ClassVar, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.core.argument_checks import floats, number
from robophm.core.errors import ModelError, nearest

Array: TypeAlias = NDArray[np.float64]

_nodes, _weights = np.polynomial.legendre.leggauss(16)
NODES: Array = (_nodes + 1) / 2  # on [0, 1]
WEIGHTS: Array = _weights / 2


FAINT = 1e-300
"""Hazard below which its digits underflow."""


class LifeDistribution(ABC):
    """The random age at failure of a part that is not repaired.

    ``dimensions`` names the parameters and the power of the clock's unit in each: 1 for a scale or location,
    0 for a plain number, −1 for a rate. ``scale_parameter`` is the one that ``with_mean``, ``with_rate`` and
    ``with_quantile`` set (of dimension 0: its logarithm); what remains is the shape.
    """

    dimensions: ClassVar[Mapping[str, int]]
    scale_parameter: ClassVar[str | None]
    any_sign: ClassVar[frozenset[str]] = frozenset({"location", "centre", "log_mean"})  # others are > 0
    closed_form: ClassVar[bool] = True  # H and h take arrays as parameters
    lowest: ClassVar[float] = 0.0  # −inf where lives reach below the location

    # What a distribution writes, of x = age − location.

    @abstractmethod
    def _cumulative_hazard(self, x: Array) -> Array: ...

    @abstractmethod
    def _hazard(self, x: Array) -> Array: ...

    @abstractmethod
    def _age_at(self, H: Array) -> Array: ...

    def _log_faint_hazard(self, x: Array) -> Array:
        """ln h where a life begins so faintly that h underflows."""
        return np.full(np.shape(x), -np.inf)

    def _step(self, x: Array, d: Array) -> Array:
        """H(x + d) − H(x) where H does not double: a closed form, if there is one, that does not cancel."""
        return integral(self._hazard, x, d)

    def _hazards(self, x: Array) -> tuple[Array, Array]:
        """The cumulative hazard H and the hazard h."""
        return self._cumulative_hazard(x), self._hazard(x)

    def _increment(self, x: Array, d: Array) -> Array:
        """H(x + d) − H(x). Where H doubles the difference is good to two bits; else the step is."""
        before, after = self._cumulative_hazard(x), self._cumulative_hazard(x + d)
        closed = np.where(after < 2 * before, self._step(x, d), after - before)
        return np.where(np.isposinf(after), np.inf, closed)

    def _new_at_pace(self, pace: Array) -> Callable[[Array], Array]:
        """H(pace·t) as a function of times t, shape (times,); shape of ``pace``, (rows, 1, draws), with all times."""
        return lambda times: self._cumulative_hazard(pace * times[:, None])

    def _mean_residual_life(self, x: Array) -> Array:
        return self._residual_moment(x, 1)

    # What follows.

    def __post_init__(self) -> None:
        """Check the parameters; ModelError where one is not a finite number, or not positive."""
        for name in self.dimensions:
            value = getattr(self, name)
            number = isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
            if not number or (name not in self.any_sign and value <= 0):
                expected = "a finite number" if name in self.any_sign else "a finite number > 0"
                raise ModelError(f"{type(self).__name__}: {name} = {value!r}, expected {expected}")
            object.__setattr__(self, name, float(value))

    @classmethod
    def with_mean(cls, mean: float, **shape: float) -> Self:
        """The distribution whose mean, location included, is ``mean`` [clock]; ``shape``: all but the scale.

        Raises ModelError where no such distribution exists, or a shape parameter is unknown or missing.
        """
        shape = cls._shape(shape)
        stated = {"mean": mean, "location": shape.get("location", 0.0)}
        mean, location = (number(one, name, low=-math.inf, error=ModelError) for name, one in stated.items())
        life = cls._positive("mean − location", mean - location)
        scale = cls._scale_parameter()
        unit = cls(**{**shape, scale: 1.0}).mean() - shape.get("location", 0.0)
        if not math.isfinite(unit):
            raise ModelError(f"{cls.__name__}: with {shape} the mean is infinite, expected a finite one")
        ratio: float = (life / unit) ** cls.dimensions[scale]
        return cls(**{**shape, scale: ratio})

    @classmethod
    def with_rate(cls, rate: float, **shape: float) -> Self:
        """The distribution of a part of which a rate [1/clock] and the shape are known: its mean is 1/rate.

        Raises ModelError, as ``with_mean``.
        """
        return cls.with_mean(1 / cls._positive("rate", rate), **shape)

    @classmethod
    def with_quantile(cls, probability: float, age: float, **shape: float) -> Self:
        """The distribution of which that share of lives has ended at ``age`` [clock]; ``shape``: all but the scale.

        ``probability`` is between 0 and 1; of an L10 or a B10 it is 0.1. Raises ModelError, as ``with_mean``.
        """
        shape, scale = cls._shape(shape), cls._scale_parameter()
        age = number(age, "age", low=-math.inf, error=ModelError)
        if not 0 < number(probability, "probability", error=ModelError) < 1:
            raise ModelError(f"{cls.__name__}: probability = {probability}, expected between 0 and 1")
        if cls.lowest == -math.inf:  # the scale moves every life
            return cls(**shape, **{scale: age - float(cls(**shape, **{scale: 0.0}).quantile(probability))})
        location = number(shape.get("location", 0.0), "location", low=-math.inf, error=ModelError)
        life = cls._positive("age − location", age - location)
        power = cls.dimensions[scale]
        unit = cls(**{**{key: shape[key] for key in shape if key != "location"}, scale: 1.0 if power else 0.0})
        ratio = cls._positive(scale, life / max(float(unit.quantile(probability)), 5e-324))
        return cls(**{**shape, scale: ratio**power if power else math.log(ratio)})

    def without_location(self) -> Self:
        """The same life with no time at its beginning in which it cannot end."""
        if getattr(self, "location", 0.0) <= 0:
            return self
        parameters = {name: getattr(self, name) for name in self.dimensions}
        return type(self)(**{**parameters, "location": 0.0})

    def rescaled(self, factor: float) -> Self:
        """The same life where every age is ``factor`` times as large, as when it is counted in another unit."""
        values: dict[str, Any] = {}
        for name, power in self.dimensions.items():
            value = np.asarray(getattr(self, name), dtype=float)
            new = value + math.log(factor) if name == "log_mean" else value * factor**power
            values[name] = new.tolist()
        return type(self)(**values)

    @property
    def nominal_rate(self) -> float:
        """The rate [1/clock] of which ``with_rate`` makes this life, 1/mean; none where that is not above zero."""
        mean = self.mean()
        return 1 / mean if mean else math.inf

    @property
    def degree(self) -> float | None:
        """β where H(θ·age) = θ^β·H(age), as of powers of age; None of others. 1: the same hazard at every age."""
        return None

    def cumulative_hazard(self, age: ArrayLike) -> Array:
        """H(age) = −ln S, 0 up to the location. [clock] → 1"""
        x = self._since_location(age)
        with limits():
            return _plain(np.where(np.isposinf(x), np.inf, self._cumulative_hazard(x)))

    def hazard(self, age: ArrayLike) -> Array:
        """h(age) [1/clock], 0 below the location; never by way of a survival that has underflowed."""
        age = floats(age, "age", ModelError)
        with limits():
            h = self._hazard(self._since_location(age))
            h = np.where(age < self._origin + self.lowest, 0.0, h)
            return _plain(np.where(np.isnan(age), np.nan, h))

    def log_hazard(self, age: ArrayLike) -> Array:
        """ln h(age) [of 1/clock], also where h is too small for a number; −inf below the location."""
        h, x = self.hazard(age), self._since_location(age)
        with limits():
            faint = (h < FAINT) & (x > self.lowest)
            return _plain(np.where(faint, self._log_faint_hazard(x) if np.any(faint) else 0.0, np.log(h)))

    def increment(self, age: ArrayLike, duration: ArrayLike) -> Array:
        """H(age + duration) − H(age) without the cancellation: a second counts at any age. [clock, clock]

        Raises ModelError where a duration is negative.
        """
        age, d = floats(age, "age", ModelError), floats(duration, "duration", ModelError)
        if np.any(d < 0):
            raise ModelError(f"{type(self).__name__}: duration = {np.min(d)}, expected ≥ 0")
        if self.lowest == 0:
            d = part_beyond(self._origin, age, d)
        with limits():
            H = self._increment(self._since_location(age), d)
            return _plain(np.where(d == 0, 0.0, H))

    def age_at(self, cumulative_hazard: ArrayLike) -> Array:
        """The age at which H reaches a value ≥ 0, the inverse of H; both tails are exact, inf gives inf.

        Raises ModelError where a value is negative.
        """
        H = floats(cumulative_hazard, "cumulative hazard", ModelError)
        if np.any(H < 0):
            raise ModelError(f"{type(self).__name__}: cumulative hazard = {np.min(H)}, expected ≥ 0")
        with limits():
            return _plain(np.where(np.isposinf(H), np.inf, self._origin + self._age_at(H)))

    def survival(self, age: ArrayLike) -> Array:
        """S(age) = exp(−H): the probability of a life longer than that."""
        return _plain(np.exp(-self.cumulative_hazard(age)))

    def failure_probability(self, age: ArrayLike) -> Array:
        """F(age) = 1 − exp(−H): the probability of failure by that age, small ones included."""
        return _plain(-np.expm1(-self.cumulative_hazard(age)))

    def density(self, age: ArrayLike) -> Array:
        """f(age) = h·S [1/clock]."""
        S = self.survival(age)
        with limits():
            return _plain(np.where(S == 0, 0.0, self.hazard(age) * S))

    def quantile(self, probability: ArrayLike) -> Array:
        """The age by which a share of lives, 0 … 1, has ended; B10 is ``quantile(0.1)``.

        Raises ModelError for what is no probability. Far in the upper tail use ``age_at(−ln S)``.
        """
        p = floats(probability, "probability", ModelError)
        if np.any((p < 0) | (p > 1)):
            raise ModelError(f"{type(self).__name__}: probability = {p}, expected 0 … 1")
        with limits():
            return self.age_at(-np.log1p(-p))

    def mean(self) -> float:
        """The mean life [clock]; inf where it does not exist."""
        with limits():
            return float(self._origin + self._mean_residual_life(np.zeros(())))

    def standard_deviation(self) -> float:
        """The standard deviation of the life [clock]; inf where it does not exist."""
        with limits():
            first, second = (self._residual_moment(np.zeros(()), order) for order in (1, 2))
            return float(np.sqrt(second - first**2))

    def mean_residual_life(self, age: ArrayLike) -> Array:
        """∫₀^∞ exp(−(H(age + x) − H(age))) dx [clock]: the mean remaining life at an age."""
        age = floats(age, "age", ModelError)
        x = self._since_location(age)
        with limits():
            wait = np.maximum(self._origin - age, 0.0) if self.lowest == 0 else 0.0
            return _plain(wait + self._mean_residual_life(x))

    @property
    def _origin(self) -> float | Array:
        origin: float | Array = getattr(self, "location", 0.0)
        return origin

    def _since_location(self, age: ArrayLike) -> Array:
        return np.maximum(floats(age, "age", ModelError) - self._origin, self.lowest)

    def _residual_moment(self, x: Array, order: int) -> Array:
        """E[(T − x)^order | T > x], over panels in each of which the increment doubles.

        In ln(T − x) powers and steps are both smooth there, so that Gauss–Legendre gives about 1e-13.
        """
        x = np.asarray(x)[..., None]
        levels = 2.0 ** np.arange(-52, 11)
        before = self._cumulative_hazard(x)
        life = self._age_at(before + levels) - x
        # Where that difference has cancelled, so little is added that H is linear.
        lost = (life < 1e-12 * np.abs(x)) | (levels < 1e-12 * before)
        life = np.where(lost, levels / self._hazard(x), life)
        life = np.maximum.accumulate(np.maximum(life, 1e-300), axis=-1)
        log_life = np.log(life)
        width = np.diff(log_life)
        t = np.exp(log_life[..., :-1, None] + width[..., None] * NODES)
        panels = width * ((t**order * np.exp(-self._increment(x[..., None], t))) @ WEIGHTS)
        moment: Array = life[..., 0] ** order + order * panels.sum(axis=-1)
        return moment

    @classmethod
    def _scale_parameter(cls) -> str:
        if cls.scale_parameter is None:
            raise ModelError(f"{cls.__name__}: no scale to set from a mean or rate, expected its parameters")
        return cls.scale_parameter

    @classmethod
    def _shape(cls, given: Mapping[str, float]) -> dict[str, float]:
        """The shape parameters, checked for names that are unknown or missing."""
        known = [name for name in cls.dimensions if name != cls._scale_parameter()]
        for name in given:
            if name not in known:
                raise ModelError(f"{cls.__name__}: no shape parameter '{name}'{nearest(name, known)}")
        for field in fields(cls):  # type: ignore[arg-type]  # each distribution is a dataclass
            if field.name in known and field.name not in given and field.default is MISSING:
                raise ModelError(f"{cls.__name__}: shape parameter '{field.name}' is missing")
        return dict(given)

    @classmethod
    def _positive(cls, name: str, value: float) -> float:
        if not isinstance(value, Real) or isinstance(value, bool) or not 0 < value < math.inf:
            raise ModelError(f"{cls.__name__}: {name} = {value!r}, expected a finite number > 0")
        return value


def limits() -> np.errstate:
    """Silence at the ends of a life, where H or h is rightly infinite and a form not chosen is 0/0."""
    return np.errstate(over="ignore", divide="ignore", invalid="ignore")


def integral(f: Callable[[Array], Array], x: Array, d: Array) -> Array:
    """∫ f from x to x + d by 16 Gauss–Legendre nodes; ``f`` is smooth there and vectorised."""
    x, d = np.asarray(x), np.asarray(d)
    total: Array = d * (f(x[..., None] + d[..., None] * NODES) @ WEIGHTS)
    return total


def part_beyond(origin: float | Array, age: Array, duration: Array) -> Array:
    """The part of a duration that lies beyond an origin, free of the rounding of age + duration.

    Source: Knuth's two-sum (The Art of Computer Programming 2, §4.2.2): end + lost is exact.
    """
    if np.all(age >= origin):
        shape = np.broadcast_shapes(np.shape(origin), age.shape, duration.shape)
        return duration if duration.shape == shape else np.broadcast_to(duration, shape)
    end = age + duration
    with limits():
        added = end - age
        lost = (age - (end - added)) + (duration - added)
        beyond = (end - origin) + np.where(np.isfinite(lost), lost, 0.0)
    return np.where(age >= origin, duration, np.clip(beyond, 0.0, duration))


def _plain(values: ArrayLike) -> Array:
    """An array of values, or a scalar for scalars."""
    plain: Array = np.asarray(values)[()]
    return plain
