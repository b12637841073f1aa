"""Lives of which some never end: a share of all parts fails at all, by a distribution
(Meeker, Technometrics 29, 1987).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from robophm.core.errors import DataError
from robophm.learning.life_data.distribution_fitting import (
    DOUBTFUL,
    FAMILIES,
    LEVEL,
    UNKNOWN,
    Bounded,
    Fit,
    as_theirs,
    fit,
    supports,
)
from robophm.learning.life_data.observed_lives import LifeData
from robophm.learning.life_data.surpyval import asked, library
from robophm.life import life_distribution
from robophm.life.distribution import LifeDistribution

OF = ("exponential", "weibull", "lognormal", "gamma", "loglogistic")
"""Distributions that may have it."""


@dataclass(frozen=True)
class LimitedFit:
    """A share of parts that ever fails, and the life of those."""

    name: str
    data: LifeData
    level: float
    share: Bounded
    parameters: Mapping[str, Bounded]
    life: LifeDistribution
    """The life distribution of the parts that fail at all."""
    log_likelihood: float
    quantiles: Mapping[float, float]
    """Quantiles of life by the share of all parts that has failed; infinite where so many never fail."""
    plain: Fit
    """The fit of the same distribution under the hypothesis that all parts fail."""

    @property
    def p_value(self) -> float:
        """P(so much likelier | all fail), half a χ²: that all fail is the edge (Self and Liang 1987)."""
        gain = 2 * (self.log_likelihood - self.plain.log_likelihood)
        return float(chdtrc(1, gain)) / 2 if gain > 0 else 1.0

    @property
    def shown(self) -> bool:
        """Whether it is shown that some never fail."""
        return self.p_value < DOUBTFUL

    @property
    def known_until(self) -> float:
        """The age beyond which the data tell nothing of a figure."""
        return UNKNOWN * self.data.longest


def fit_limited(data: LifeData, name: str = "weibull", *, level: float = LEVEL) -> LimitedFit:
    """Fit a share that ever fails beside a distribution, by maximum likelihood. Raises DataError, in words."""
    if name not in OF:
        raise DataError(f"a {name} life with parts that never fail is not known; expected {', '.join(OF)}")
    supports(data, name)
    if data.failures < len(FAMILIES[name].parameters) + 1:
        raise DataError(f"{data.source}: {data.failures} failures: too few for {len(FAMILIES[name].parameters) + 1} "
                        "parameters; expected at least as many")  # fmt: skip
    if data.failures == data.parts:
        raise DataError(f"{data.source}: all {data.parts} parts failed; expected some that still worked")
    family, plain = FAMILIES[name], fit(data, name, level=level)
    with asked(f"{data.source}: {name}, of which some never fail"):
        model = getattr(library(), family.theirs).fit(**as_theirs(data), lfp=True)
        values = dict(zip(model.parameter_names, (float(one) for one in model.params), strict=False))
        values["lfp_p"] = float(model.lfp_p)
        if not all(map(math.isfinite, values.values())):
            raise DataError(f"{data.source}: no best fit of which some never fail; expected more failures")

        def bounded(theirs: str, *, inverse: bool = False) -> Bounded:
            low, high = (float(end) for end in model.param_cb(theirs, alpha_ci=1 - level))
            ends = values[theirs], low, high
            return Bounded(1 / ends[0], 1 / ends[2], 1 / ends[1]) if inverse else Bounded(*ends)

        parameters = {ours: bounded(theirs, inverse=inverse) for ours, (theirs, inverse) in family.parameters.items()}
        share = bounded("lfp_p")
        log_likelihood = -float(model.neg_ll())
    life = life_distribution(family.ours)(**{ours: one.value for ours, one in parameters.items()})
    quantiles = {
        p: float(life.quantile(p / share.value)) if p < share.value else math.inf for p in (0.001, 0.01, 0.1, 0.5)
    }
    if not np.isfinite(log_likelihood):
        raise DataError(f"{data.source}: no best fit of which some never fail; expected more failures")
    return LimitedFit(name, data, level, share, parameters, life, log_likelihood, quantiles, plain)
