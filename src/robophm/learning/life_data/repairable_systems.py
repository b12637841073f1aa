"""Systems that are repaired and go on: whether their failures come faster or slower, by a power law of time.

Crow–AMSAA: failures are a Poisson process of mean λ·t^β. β < 1 improves, β > 1 wears, β = 1 neither.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from scipy.special import chdtr, chdtri, gammainc, ndtri

from robophm.core.errors import DataError
from robophm.core.root import root
from robophm.learning.life_data.distribution_fitting import DOUBTFUL, LEVEL, Bounded
from robophm.learning.life_data.observed_lives import LifeData
from robophm.learning.life_data.surpyval import asked, library


@dataclass(frozen=True)
class PowerLaw:
    """The power law of the failures of repaired systems over time."""

    systems: int
    failures: int
    shape: Bounded
    """Exponent β of the power law."""
    scale: float
    """λ, of λ·t^β failures of one system by t."""
    until: float
    """Time when the last system was last seen [unit of the data]."""
    mean_time: Bounded
    """Mean time between failures at ``until``."""
    p_value: float
    """P(a trend so clear | none): MIL-HDBK-189's χ² of 2·Σ ln(T/t)."""
    at_failure: bool = False
    """Whether watching ended with the last failure (failure truncated), not at a time."""
    unbiased: bool = False
    """Whether β is Crow's unbiased estimate; else that of maximum likelihood."""

    @property
    def estimate(self) -> str:
        """Return the name of the estimate on which β, and all that follows from it, rests."""
        return "unbiased" if self.unbiased else "maximum likelihood"

    @property
    def trend(self) -> Literal["improving", "wearing"] | None:
        """Return whether failures come less or more often as time goes on; None where neither is shown."""
        if self.p_value >= DOUBTFUL:
            return None
        return "improving" if self.shape.value < 1 else "wearing"

    @property
    def intensity(self) -> float:
        """Return the failures of one system per unit of time, at ``until``."""
        return 1 / self.mean_time.value


def fit_power_law(
    times: Mapping[str, Sequence[float]], ends: Mapping[str, float], *, level: float = LEVEL, unbiased: bool = True
) -> PowerLaw:
    """Fit the power law to the failure times of each system, each watched from 0 to its end.

    ``unbiased``: with n − 1 in the place of n, as NIST and Crow do, n − 2 where one system was watched until its last
    failure, which is its end then; else maximum likelihood. Intervals of the time between failures are NIST's
    (e-Handbook 8.4.5.2), of one watched until its last failure exact (Lee and Lee, Technometrics 20, 1978). Raises
    DataError where there are too few failures.
    """
    for item, some in times.items():
        if not ends.get(item, 0) > 0:
            raise DataError(f"'{item}' was watched for no time; expected until when, a row with censored: yes")
        if any(not 0 < t <= ends[item] for t in some):
            raise DataError(
                f"'{item}' fails at {min(some):g} … {max(some):g}; expected after 0, by {ends[item]:g}, its end"
            )
    n = sum(map(len, times.values()))
    if n < 3:
        raise DataError(f"{n} failure{'s' * (n != 1)} of repaired systems: a trend needs at least 3")
    logs = sum(math.log(ends[item] / t) for item, some in times.items() for t in some)
    if not logs > 0:
        raise DataError("all failures are at the very end of what was watched: no trend to fit; expected times apart")
    until = max(ends.values())
    at_failure = any(some and max(some) == ends[item] for item, some in times.items())
    if at_failure and len(ends) > 1:
        raise DataError("of several systems one ends with its failure; expected until when each was watched, a time")
    free = n - at_failure  # 2β·Σ ln(T/t) is χ² of twice as many degrees of freedom
    if len(set(ends.values())) == 1:
        of = free - 1 if unbiased else n
        shape = of / logs
    else:
        shape, unbiased, of = _of_unequal(times, ends), False, n
    scale = n / sum(end**shape for end in ends.values())
    rate = scale * shape * until ** (shape - 1)
    tail = (1 - level) / 2
    bounds = (shape * chdtri(2 * free, above) / (2 * of) for above in (1 - tail, tail))
    low, high = _between_failures(n, of, tail) if not at_failure else _between_failures_at_last(n, of, tail)
    p = float(chdtr(2 * free, 2 * logs))
    return PowerLaw(
        len(ends), n, Bounded(shape, *(float(one) for one in bounds)), scale, until,
        Bounded(1 / rate, low / rate, high / rate), 2 * min(p, 1 - p), at_failure, unbiased,
    )  # fmt: skip


def _between_failures(n: int, of: int, tail: float) -> tuple[float, float]:
    """Bounds of the time between failures at the end of a test that ended at a time, over its estimate; ``of``: n of
    maximum likelihood, n − 1 unbiased, so that bounds are the same by both.
    """
    z = float(ndtri(1 - tail))
    below = n - z * math.sqrt(n / 2)
    low = n * of / (n + z**2 / 4 + math.sqrt(n * z**2 / 2 + z**4 / 16)) ** 2
    return low, n * of / below**2 if below > 0 else math.inf


def _between_failures_at_last(n: int, of: int, tail: float) -> tuple[float, float]:
    """The same of a test that ended with its n-th failure: the true intensity over the likeliest is Z·S/4n², χ² both,
    Z of 2n − 2 degrees of freedom, S of 2n.
    """
    nodes = chdtri(2 * n - 2, (np.arange(1000) + 0.5) / 1000)

    def miss(log_product: float, share: float) -> float:
        return float(np.mean(gammainc(n, math.exp(log_product) / (2 * nodes)))) - share

    products = (math.exp(root(partial(miss, share=share), -30.0, 60.0)) for share in (1 - tail, tail))
    low, high = (4 * n * of / one for one in products)
    return low, high


def power_laws(data: LifeData, *, level: float = LEVEL) -> dict[str, PowerLaw]:
    """Fit the power law by both estimates of its exponent, the unbiased one first; each failure is a row.

    Of systems that were not watched equally long there is none that is unbiased. Raises DataError as ``systems`` and
    ``fit_power_law``.
    """
    times, ends = systems(data)
    try:
        both = [fit_power_law(times, ends, level=level, unbiased=one) for one in (True, False)]
    except DataError as error:
        raise DataError(f"{data.source}: {error}") from None
    return {one.estimate: one for one in both}


def _of_unequal(times: Mapping[str, Sequence[float]], ends: Mapping[str, float]) -> float:
    """β of systems that were not watched equally long, by SurPyval."""
    x: list[float] = []
    item: list[str] = []
    kind: list[int] = []
    for name, end in ends.items():
        for t in times.get(name, ()):
            x, item, kind = [*x, t], [*item, name], [*kind, 0]
        x, item, kind = [*x, end], [*item, name], [*kind, 1]
    with asked("power law"):
        return float(library("recurrent").CrowAMSAA.fit(x, i=item, c=kind).params[1])


def fit_grouped(ends: Sequence[float], counts: Sequence[int]) -> tuple[float, float]:
    """λ and β of one system whose failures were counted between times, from 0 on (MIL-HDBK-189).

    Raises DataError where that says nothing of a trend.
    """
    if len(ends) != len(counts) or len(ends) < 2 or sum(counts) < 3:
        raise DataError(f"{sum(counts)} failures in {len(ends)} intervals; expected at least 3 in 2")
    edges = [0.0, *ends]
    if any(not b > a for a, b in zip(edges, ends, strict=False)):
        raise DataError("intervals do not follow one another; expected ends that ascend from 0")
    with asked("grouped failures"):
        rows = [[a, b] for a, b in zip(edges, ends, strict=False)]
        alpha, beta = library("recurrent").CrowAMSAA.fit(rows, c=[2] * len(rows), n=list(counts)).params
    return float(alpha) ** -float(beta), float(beta)


def mean_time_between(failures: int, hours: float, *, level: float = LEVEL) -> Bounded:
    """Mean time between failures of a constant rate, of a test that ended at a time  (χ², NIST 8.4.5.1)."""
    tail = (1 - level) / 2
    low = 2 * hours / float(chdtri(2 * failures + 2, tail))
    high = 2 * hours / float(chdtri(2 * failures, 1 - tail)) if failures else math.inf
    return Bounded(hours / failures if failures else math.inf, low, high)


def systems(data: LifeData) -> tuple[dict[str, list[float]], dict[str, float]]:
    """Failure times of each item and how long it was watched. Raises DataError where that is not said."""
    if data.stresses:
        raise DataError(f"{data.source}: repaired systems are taken at one stress; it has {', '.join(data.stresses)}")
    for said, column in ((len(data.since), "since"), (data.modes, "mode")):
        if said:
            raise DataError(f"{data.source}: of repaired systems '{column}' is not known; expected none such")
    if np.any(data.count != 1):
        raise DataError(f"{data.source}: each failure of a repaired system is a row; expected no count but 1")
    if not data.items:
        raise DataError(f"{data.source}: whose failures are they? expected a column 'item'")
    if np.any(data.failed & (data.low != data.high)):
        raise DataError(f"{data.source}: repaired systems are taken at known times; these have intervals")
    times: dict[str, list[float]] = {item: [] for item in data.items}
    ends: dict[str, float] = {}
    for item, t, failed in zip(data.items, data.low.tolist(), data.failed.tolist(), strict=True):
        if failed:
            times[item].append(t)
        elif item in ends:
            raise DataError(f"{data.source}: '{item}' ends twice, at {ends[item]:g} and {t:g}; expected once")
        else:
            ends[item] = t
    if len(times) == 1 and not ends and (only := next(iter(times))) and len(times[only]) > 0:
        ends[only] = max(times[only])  # watched until its last failure
    for item in times:
        if item not in ends:
            raise DataError(f"{data.source}: until when was '{item}' watched? expected a row of it with censored: yes")
    return times, ends
