"""Updated rates of failure modes from field failures: how far each stated rate is off, and how sure that is."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import chdtri, gammaln

from robophm.core.errors import DataError, UnitError
from robophm.core.spread import deviation_of
from robophm.core.units import quantity
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot, Uncertainty
from robophm.learning.rates.failure_log import Seen, merged
from robophm.learning.rates.fleet import ExpectedFailures, Fleet, Powers, StatedRateRatio, fleet
from robophm.learning.rates.gamma_poisson import VAGUEST, Posterior, update
from robophm.learning.rates.life_scale import at_rate, fit_scale, information

USUAL_PRIOR = 1.0
"""Failures that a stated rate counts as, where neither the design nor the user says more."""


MOST_PRIOR = 1e9
"""The most failures that a stated rate may count as: its error is then 30 millionths."""


@dataclass(frozen=True)
class LearnedRate:
    """The updated rate of one failure mode."""

    mode: FailureMode
    stated: float
    """Rate as stated, whatever was learned before [1 per unit of its clock]."""
    failures: float
    expected: float
    """Failures expected by the stated rate."""
    exposure: float
    """The exposure of all robots together [unit of the mode's clock]."""
    posterior: Posterior
    """The posterior of the ratio of the true hazard to the stated one, of all robots together."""
    fleet: Fleet
    """How many times the stated one the rates are: of the fleet's mean, of the next robot, of each of ``robots``."""
    robots: tuple[str, ...]
    failures_of: tuple[float, ...]
    """The number of failures of each of ``robots``."""
    of: str | None = None
    """The robot that was asked for; None: the next one of this fleet, of which nothing else is known."""

    @property
    def ratio(self) -> StatedRateRatio:
        """The posterior of the ratio of the true rate to the stated one, for the robot that was asked for."""
        return self.fleet.robots[self.robots.index(self.of)] if self.of in self.robots else self.fleet.next

    @property
    def factor(self) -> float:
        """The rate is so many times the stated one: that at which the hazard is what is now to be expected."""
        return self.ratio.times

    @property
    def shape(self) -> float:
        """The number of failures that would make the factor as certain as it is."""
        return self.ratio.shape

    @property
    def low(self) -> float:
        """The factor is above this with 95 %."""
        return self.ratio.low

    @property
    def high(self) -> float:
        """The factor is below this with 95 %."""
        return self.ratio.high

    @property
    def rate(self) -> float:
        """Return the updated rate [1 per unit of its clock]."""
        return self.stated * self.factor


def learn(
    robot: Robot, seen: Iterable[Seen], prior: str | None = None, of: str | None = None, *, each_robot: bool = True
) -> list[LearnedRate]:
    """Return how far each stated rate is off, for failure modes of which anything was seen; in design order.

    What was seen of one failure mode in one robot adds up. A rate that is unknown cannot be off: see ``unstated``.
    ``prior``: what stated rates count as, such as '10000 h' or '2 failures'; else what the design's ``uncertainty``
    says, else one failure. ``of``: one robot of the fleet, else what is known of any; ``each_robot``: with each
    robot's own rate, which of many takes most of the time. Raises DataError.
    """
    by_mode: dict[str, list[Seen]] = {}
    for one in merged(seen):
        by_mode.setdefault(one.mode.path, []).append(one)
    names = sorted({one.robot for some in by_mode.values() for one in some})
    if of is not None and of not in names:
        raise DataError(f"no robot '{of}' in what was seen; there are {', '.join(names[:12]) or 'none'}")
    return [
        _learned(mode, by_mode[mode.path], prior, of, each_robot=each_robot)
        for mode in robot.modes
        if mode.path in by_mode and not mode.unknown
    ]


@dataclass(frozen=True)
class UnstatedRate:
    """The field's estimate of a failure mode whose stated rate is unknown, as if its rate were constant."""

    mode: FailureMode
    failures: float
    exposure: float
    """Exposure of all parts together [unit of its clock]."""

    @property
    def rate(self) -> float:
        """Return the likeliest rate [1 per unit of its clock]; not a number where nothing was gone through."""
        return self.failures / self.exposure if self.exposure > 0 else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """Return its 90 % interval, exact (Garwood, Biometrika 28, 1936); of no failure, below the second with 95 %."""
        if not self.exposure > 0:
            return 0.0, math.inf
        low = float(chdtri(2 * self.failures, 0.95)) if self.failures else 0.0
        return low / (2 * self.exposure), float(chdtri(2 * self.failures + 2, 0.05)) / (2 * self.exposure)


def unstated(robot: Robot, seen: Iterable[Seen]) -> list[UnstatedRate]:
    """Return estimates of the unknown rates of which anything was seen, all robots together; in design order."""
    found: dict[str, list[Seen]] = {}
    for one in merged(seen):
        if one.mode.unknown:
            found.setdefault(one.mode.path, []).append(one)
    return [
        UnstatedRate(mode, math.fsum(one.failures for one in found[mode.path]),
                     math.fsum(one.exposure for one in found[mode.path]))
        for mode in robot.modes if mode.path in found
    ]  # fmt: skip


class Promised(NamedTuple):
    """Failures of a failure mode in each of some robots, beside those that its rate would have promised them."""

    failures: list[float]
    by_rate: ExpectedFailures
    together: Posterior
    """The posterior of the ratio of the true hazard to the stated one, if all robots have the same."""


def promised(mode: FailureMode, seen: Sequence[Seen], prior: str | None = None) -> Promised:
    """Return what a failure mode's stated rate promised each of some robots, at least one. Raises DataError."""
    factor, failures = mode.evidence.factor if mode.evidence else 1.0, [one.failures for one in seen]
    if mode.life.degree is not None:
        beta = mode.life.degree
        expected = np.array([one.expected / factor**beta for one in seen])
        strength = _strength(mode, mode.rate / factor, beta, prior)
        return Promised(failures, Powers(expected, beta), update(math.fsum(failures), math.fsum(expected), strength))
    try:
        life = at_rate(mode.life, 1 / factor)
        beta = information(life)
        summed = math.fsum(
            one.parts * float(life.increment(one.start, one.length)) for some in seen for one in some.lives
        )
        strength = _strength(mode, mode.rate / factor, beta, prior)
        found, by_rate = fit_scale(life, [one.lives for one in seen], summed, strength, beta)
    except DataError as error:
        raise DataError(f"'{mode.path}': {error}") from None
    return Promised(failures, by_rate, found)


def _learned(
    mode: FailureMode, seen: Sequence[Seen], prior: str | None, of: str | None, *, each_robot: bool
) -> LearnedRate:
    n, by_rate, found = promised(mode, seen, prior)
    return LearnedRate(
        mode, mode.rate / (mode.evidence.factor if mode.evidence else 1.0), math.fsum(n), found.expected,
        math.fsum(one.exposure for one in seen), found, fleet(n, by_rate, found, each_robot=each_robot),
        tuple(one.robot for one in seen), tuple(n), of,
    )  # fmt: skip


def _strength(mode: FailureMode, rate: float, beta: float, prior: str | None) -> float:
    """Failures that a stated rate counts as, as a gamma of the hazard."""
    if prior is not None:
        return _said(mode, rate, prior)
    stated = mode.evidence.stated if mode.evidence else mode.uncertainty
    return USUAL_PRIOR if stated is None else max(1 / _square_of_variation(stated, beta), VAGUEST)


def _said(mode: FailureMode, rate: float, prior: str) -> float:
    number, _, unit = prior.strip().partition(" ")
    unit_of_clock = CLOCK_UNITS[mode.clock]
    try:
        if unit.strip() in ("failure", "failures"):
            value = quantity(number, "")
        else:
            value = quantity(prior, unit_of_clock) * rate
    except UnitError as error:
        raise DataError(
            f"prior '{prior:.40}': {error} ('{mode.path}' ages by {unit_of_clock}); expected e.g. '2 failures'"
        ) from None
    if not value > 0:
        raise DataError(f"prior '{prior:.40}': expected more than nothing, e.g. '0.5 failures' or '1000 h'")
    if value > MOST_PRIOR:
        raise DataError(f"prior '{prior:.40}' counts as {value:.3g} failures of '{mode.path}'; expected at most "
                        f"{MOST_PRIOR:g}: a rate that is surer than that is not learned")  # fmt: skip
    return value


def _square_of_variation(uncertainty: Uncertainty, beta: float) -> float:
    """Squared coefficient of variation of θ^β, with what an unknown quality makes of it."""
    factors = [uncertainty.error_factor, uncertainty.quality.error_factor if uncertainty.quality else None]
    logarithm = sum((beta * deviation_of(factor)) ** 2 for factor in factors if factor is not None)
    if uncertainty.failures is not None:
        k = uncertainty.failures
        logarithm += float(gammaln(k + 2 * beta) + gammaln(k) - 2 * gammaln(k + beta))
    if uncertainty.samples is not None:
        powers = np.array(uncertainty.samples) ** beta
        logarithm += math.log1p(max(float(powers.var() / powers.mean() ** 2), 1e-9))
    return math.expm1(min(logarithm, 700.0))
