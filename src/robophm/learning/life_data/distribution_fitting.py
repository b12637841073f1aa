"""Life distributions fitted to life data by SurPyval: parameters with intervals, how well they fit, which fits best."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError, ModelError, nearest
from robophm.learning.life_data.observed_lives import LifeData
from robophm.learning.life_data.surpyval import asked, library
from robophm.life import life_distribution
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]
How = Literal["likelihood", "ranks"]

LEVEL = 0.9
"""Confidence level of intervals, unless said otherwise."""


class Family(NamedTuple):
    """A distribution as it is called there and here."""

    theirs: str
    ours: str
    parameters: Mapping[str, tuple[str, bool]]
    """Name of SurPyval's parameter for each of ours, and whether ours is its reciprocal."""
    offset: bool = False


FAMILIES: Mapping[str, Family] = {
    "exponential": Family("Exponential", "exponential", {"rate": ("failure_rate", False)}),
    "weibull": Family("Weibull", "weibull", {"scale": ("alpha", False), "shape": ("beta", False)}),
    "weibull3": Family("Weibull", "weibull", {"scale": ("alpha", False), "shape": ("beta", False)}, True),
    "lognormal": Family("LogNormal", "lognormal", {"log_mean": ("mu", False), "log_deviation": ("sigma", False)}),
    "normal": Family("Normal", "normal", {"centre": ("mu", False), "deviation": ("sigma", False)}),
    "gamma": Family("Gamma", "gamma", {"shape": ("alpha", False), "scale": ("beta", True)}),
    "loglogistic": Family("LogLogistic", "loglogistic", {"scale": ("alpha", False), "shape": ("beta", False)}),
    "gumbel": Family("Gumbel", "extreme_value", {"location": ("mu", False), "scale": ("sigma", False)}),
}
"""The distributions that can be fitted, by name; 'weibull3' has a location too."""

FEWEST: Mapping[str, int] = {"exponential": 1, "weibull3": 5}
"""Failures that a distribution needs; two where it is not here."""

AS_GOOD = 2.0
"""Difference of AIC below which two distributions are as good as each other (Burnham and Anderson 2002)."""

DOUBTFUL = 0.05
"""p below which data do not go with what was fitted to them."""

FAR = 10.0
"""Times the longest time at which anything was seen, beyond which a figure rests on a distribution's shape alone."""

UNKNOWN = 100.0
"""The same, beyond which it is not told at all."""

MOST_UNSEEN = 0.01
"""Share of lives at ages at which nothing was watched from which on that is said, and probability of as few failures
as were seen below which a line through ranks is doubted."""

MOST_BELOW_ZERO = 0.01
"""Share of lives below zero from which on a distribution is no life."""


class Bounded(NamedTuple):
    """A figure and its interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Fit:
    """The result of fitting one distribution to life data."""

    name: str
    data: LifeData
    how: How
    level: float
    parameters: Mapping[str, Bounded]
    """Parameters by our names; a location has no interval."""
    life: LifeDistribution
    log_likelihood: float
    aic: float
    aic_corrected: float
    """AIC corrected for small samples (Hurvich and Tsai, Biometrika 76, 1989); infinite for too few parts."""
    quantiles: Mapping[float, Bounded]
    mean: float
    straightness: float
    """R² of the probability plot."""
    plot: ProbabilityPlot
    covariance: Array = field(default_factory=lambda: np.empty((0, 0)))
    """Covariance of the library's own parameters, in their order."""
    notes: tuple[str, ...] = ()
    model: Any = None
    """The fitted model of the library itself."""

    def __repr__(self) -> str:
        return f"<Fit {self.name} of {self.data.described()}: mean {self.mean:.4g}, AIC {self.aic:.4g}>"

    @property
    def known_until(self) -> float:
        """The age beyond which the data tell nothing of a figure."""
        return UNKNOWN * seen_long(self.data, self.name)

    @property
    def below_zero(self) -> float:
        """Share of lives that it has below zero."""
        return float(self.life.failure_probability(0.0))


class ProbabilityPlot(NamedTuple):
    """Failures at their plotting positions, on axes on which the distribution is a straight line; shapes (points,)."""

    times: Array
    failed: Array
    """Share that has failed by then (Benard's median ranks, adjusted for what was censored)."""
    x: Array
    y: Array


def fit(data: LifeData, name: str = "weibull", *, how: How = "likelihood", level: float = LEVEL) -> Fit:
    """Fit one distribution to life data. ``how``: maximum likelihood, or median ranks regressed (time on rank).

    Raises DataError, in words, where the data do not support it; RobophmError where SurPyval is not installed.
    """
    if name not in FAMILIES:
        raise DataError(f"no distribution '{name}'{nearest(name, FAMILIES)}")
    supports(data, name)
    if how == "ranks" and len(data.since):
        raise DataError(
            f"{data.source}: ranks know nothing of parts not watched from new; expected a fit by likelihood"
        )
    family, sp = FAMILIES[name], library()
    with asked(f"{data.source}: {name}") as said:
        options: dict[str, Any] = (
            {"how": "MLE"} if how == "likelihood" else {"how": "MPP", "rr": "x", "heuristic": "Benard"}
        )
        if family.offset:
            options["offset"] = True
        model = getattr(sp, family.theirs).fit(**as_theirs(data), **options)
        if not np.all(np.isfinite(model.params)):
            raise DataError(f"{data.source}: {name} has no best fit here; expected data that spread more")
        found = _fit(data, name, how, level, model)
    if any(one.startswith("No finite maximum") for one in said):
        raise DataError(f"{data.source}: {name} has no best fit here: ever more extreme parameters go ever better with "
                        "these data")  # fmt: skip
    return Fit(**{**found, "notes": (*found["notes"], *_told(said))})


def fit_all(data: LifeData, names: Sequence[str] = (), *, level: float = LEVEL) -> tuple[list[Fit], dict[str, str]]:
    """Every distribution that the data support, the best by its corrected AIC first; and why the others are not there.

    Those that put more than MOST_BELOW_ZERO of all lives below zero come last. Raises DataError where none fits.
    """
    found, refused = [], {}
    chosen = names or [name for name in FAMILIES if name != "weibull3"]
    supports(data, "weibull" if len(chosen) > 1 else chosen[0])
    for name in chosen:
        try:
            found.append(fit(data, name, level=level))
        except (DataError, ModelError) as error:
            refused[name] = str(error).removeprefix(f"{data.source}: ")
    if not found:
        raise DataError(f"{data.source}: no distribution fits: {next(iter(refused.values()))}")
    corrected = can_be_corrected(found)
    found.sort(key=lambda one: (one.below_zero > MOST_BELOW_ZERO, one.aic_corrected if corrected else one.aic))
    return found, refused


def can_be_corrected(fits: Sequence[Fit]) -> bool:
    """Whether all fits have a corrected AIC, by which they are ranked; with three parts or so there is none."""
    return all(math.isfinite(one.aic_corrected) for one in fits)


def as_good_as_best(fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits, of some to the same data with the best first, that cannot be told from the best."""
    scores = [one.aic_corrected if can_be_corrected(fits) else one.aic for one in fits]
    return [one for one, score in zip(fits[1:], scores[1:], strict=True) if score < scores[0] + AS_GOOD]


def supports(data: LifeData, name: str) -> None:
    """Raise DataError, and say what would be needed, where data cannot tell a distribution's parameters."""
    if data.items_repeat:
        raise DataError(
            f"{data.source}: items have several rows; expected one life each, or repaired systems with their power law"
        )
    needed = FEWEST.get(name, 2)
    if data.failures == 0:
        total = float((data.count * (data.low - data.began)).sum())
        raise DataError(
            f"{data.source}: no failure among {data.parts} parts: nothing can be fitted, only that a constant rate "
            f"would be below {-math.log(0.05) / total:.3g} /{data.unit or 'unit'} with 95 %; expected at least "
            f"{needed} failures, or `robophm learn`, which weighs it against the stated rate"
        )
    if data.failures < needed:
        raise DataError(
            f"{data.source}: {data.failures} failure{'s' * (data.failures > 1)}: too few for {name}, which has "
            f"{len(FAMILIES[name].parameters) + FAMILIES[name].offset} parameters; expected at least {needed}"
            + (", or an exponential distribution" if data.failures == 1 else "")
        )
    exact = data.low == data.high
    times = np.unique(data.low[exact])
    vague = data.failed & ~exact
    if name != "exponential" and not vague.any() and len(times) == 1:
        raise DataError(
            f"{data.source}: all {data.failures} failures at {times[0]:g} {data.unit}: no spread to fit; expected at "
            "least two different times, or intervals, if that is when somebody looked"
        )
    if name != "exponential" and not exact.any() and not _overlapping(data):
        raise DataError(
            f"{data.source}: its intervals do not tell a spread: any narrow one fits; expected two that part, "
            "or a failure at a known time"
        )


def _overlapping(data: LifeData) -> bool:
    """Whether no single moment explains all rows."""
    return bool(data.low.max() >= data.high.min())


def as_theirs(data: LifeData) -> dict[str, Any]:
    """Lives as SurPyval takes them."""
    late = {"tl": data.since} if len(data.since) else {}
    exact, left = data.low == data.high, data.failed & (data.low == 0)
    kind = np.where(exact, 0, np.where(~data.failed, 1, np.where(left, -1, 2)))
    if not np.any(kind == 2):
        return {"x": np.where(kind == -1, data.high, data.low), "c": kind, "n": data.count.astype(int), **late}
    ends = np.where(kind == 2, data.high, np.where(kind == -1, data.high, data.low))
    starts = np.where(kind == -1, data.high, data.low)
    return {"x": np.stack([starts, ends], axis=1), "c": kind, "n": data.count.astype(int), **late}


def _fit(data: LifeData, name: str, how: How, level: float, model: Any) -> dict[str, Any]:
    family, tail = FAMILIES[name], 1 - level
    values = dict(zip(model.parameter_names, (float(one) for one in model.params), strict=False))
    sure = how == "likelihood"
    parameters = {}
    for ours, (theirs, inverse) in family.parameters.items():
        low, high = (float(end) for end in model.param_cb(theirs, alpha_ci=tail)) if sure else (math.nan, math.nan)
        ends = (values[theirs], low, high)
        parameters[ours] = Bounded(*((1 / ends[0], 1 / ends[2], 1 / ends[1]) if inverse else ends))
    location = float(model.gamma) if family.offset else 0.0
    if family.offset:
        parameters["location"] = Bounded(location, math.nan, math.nan)
    life = life_distribution(family.ours)(**{ours: one.value for ours, one in parameters.items()})
    levels = (0.01, 0.1, 0.5, 0.9)
    with np.errstate(all="ignore"):
        bounds = model.quantile_cb(levels, alpha_ci=tail) if sure else np.full((len(levels), 2), math.nan)
    quantiles = {
        p: Bounded(float(life.quantile(p)), float(low), float(high))
        for p, (low, high) in zip(levels, np.asarray(bounds).reshape(-1, 2), strict=True)
    }
    points, straightness = _plot(data, life, name)
    free = len(family.parameters) + family.offset
    log_likelihood = -float(model.neg_ll()) if sure else _log_likelihood(data, life)
    rest = data.parts - free - 1
    aic = 2 * free - 2 * log_likelihood
    corrected = aic + (2 * free * (free + 1) / rest if rest > 0 else math.inf)
    notes = []
    if family.offset and location >= 0.999 * float(data.low[data.failed].min()):
        notes.append("the location has run into the first failure: a third parameter is more than these data tell")
    if name == "weibull" and (shape := parameters["shape"]).low < 1 < shape.high:
        notes.append("the shape's interval holds 1: that parts wear, or fail early, is not shown")
    if far := extrapolation_note(life.mean(), data, name):
        never = (
            "; a fit with parts that never fail says whether some never will" if data.failures < data.parts / 2 else ""
        )
        notes.append(f"its mean {far}{never}")
    notes += _beside_the_data(data, life, how)
    covariance = np.asarray(model.covariance()) if sure else np.empty((0, 0))
    return {
        "name": name, "data": data, "how": how, "level": level, "parameters": parameters, "life": life,
        "log_likelihood": log_likelihood, "aic": aic, "aic_corrected": corrected, "quantiles": quantiles,
        "mean": life.mean(),
        "straightness": straightness, "plot": points, "covariance": covariance, "notes": tuple(notes), "model": model,
    }  # fmt: skip


def _beside_the_data(data: LifeData, life: LifeDistribution, how: How) -> list[str]:
    """Warnings of a life that says much of ages at which nothing was watched, or forgets what still worked."""
    from scipy.special import pdtr

    notes = []
    youngest = float(data.began.min())
    if youngest > 0 and (before := float(life.failure_probability(youngest))) > MOST_UNSEEN:
        notes.append(
            f"{100 * before:.3g} % of its lives end before {youngest:.4g} {data.unit}".rstrip()
            + ", younger than anything was watched: that rests on the shape of the distribution alone"
        )
    if how == "ranks":
        expected = float((data.count * life.cumulative_hazard(data.low)).sum())
        if pdtr(data.failures, expected) < MOST_UNSEEN:
            notes.append(
                f"by this line {expected:.3g} failures would have been expected where {data.failures} were seen: ranks "
                "forget for how long the parts that did not fail still worked; a fit by likelihood does not"
            )
    return notes


def seen_long(data: LifeData, name: str) -> float:
    """The longest time that tells of a distribution's figures; of a constant rate, all times together."""
    return float((data.count * (data.low - data.began)).sum()) if name == "exponential" else data.longest


def extrapolation_note(value: float, data: LifeData, name: str) -> str:
    """A warning about a figure that is extrapolated far beyond the longest time seen; "" where it is not."""
    times = value / seen_long(data, name)
    if times <= FAR:
        return ""
    if times <= UNKNOWN:
        return f"lies {times:.0f} times beyond the longest time seen: it rests on the shape of the distribution alone"
    return f"would lie more than {UNKNOWN:g} times beyond the longest time seen, of which these data tell nothing"


def _told(said: Sequence[str]) -> list[str]:
    """The library's warnings that are about these data, each once."""
    return list(dict.fromkeys(one for one in said if "offset" not in one.lower()))[:3]


def _log_likelihood(data: LifeData, life: LifeDistribution) -> float:
    exact = data.low == data.high
    with np.errstate(divide="ignore"):
        known = np.log(life.hazard(data.low)) - life.cumulative_hazard(data.low)
        within = np.log(np.maximum(life.survival(data.low) - life.survival(data.high), 1e-300))
        return float(np.sum(data.count * np.where(exact, known, within)))


def _plot(data: LifeData, life: LifeDistribution, name: str) -> tuple[ProbabilityPlot, float]:
    """Failures at their adjusted median ranks (Johnson 1964; Benard), intervals at their middle."""
    middle = np.where(data.failed, (data.low + data.high) / 2, data.low)
    order = np.lexsort((~data.failed, middle))
    total, gone, rank = float(data.count.sum()), 0.0, 0.0
    entered = np.sort(data.began)
    counted = np.concatenate([[0.0], np.cumsum(data.count[np.argsort(data.began)])])
    times, ranks = [], []
    for i in order:
        number = float(data.count[i])
        if data.failed[i]:
            left = float(counted[np.searchsorted(entered, middle[i])]) - gone  # who was watched then
            for _ in range(min(int(number), 10_000)):
                rank += (total + 1 - rank) / (left + 1)
                left -= 1
            times.append(float(middle[i]))
            ranks.append(rank)
        gone += number
    at, failed = np.array(times), (np.array(ranks) - 0.3) / (total + 0.4)
    x, y = straight(name, at, failed, float(getattr(life, "location", 0.0)) if name == "weibull3" else 0.0)
    if len(at) < 2 or np.ptp(x) == 0 or np.ptp(y) == 0:
        return ProbabilityPlot(at, failed, x, y), math.nan
    if name == "exponential":  # through the origin
        slope = float(x @ y / (x @ x))
        return ProbabilityPlot(at, failed, x, y), 1 - float(np.sum((y - slope * x) ** 2) / np.sum((y - y.mean()) ** 2))
    if name == "gamma":  # has no axes of its own: as predicted and observed
        y = np.log(np.asarray(life.quantile(failed)))
        return ProbabilityPlot(at, failed, x, y), float(np.corrcoef(x, y)[0, 1] ** 2)
    return ProbabilityPlot(at, failed, x, y), float(np.corrcoef(x, y)[0, 1] ** 2)


def straight(name: str, times: Array, failed: Array, location: float = 0.0) -> tuple[Array, Array]:
    """Times and shares failed on the axes of a distribution's probability paper."""
    from scipy.special import logit, ndtri

    with np.errstate(divide="ignore", invalid="ignore"):
        x = times if name in ("exponential", "normal", "gumbel") else np.log(times - location)
        if name == "exponential":
            return x, -np.log1p(-failed)
        if name in ("lognormal", "normal"):
            return x, ndtri(failed)
        if name == "loglogistic":
            return x, logit(failed)
        return x, np.log(-np.log1p(-failed))


class Goodness(NamedTuple):
    """Anderson and Darling's measure of how well a distribution fits."""

    statistic: float
    p_value: float
    """P(one so large | the distribution is right)."""

    @property
    def doubtful(self) -> bool:
        """Whether the test says that the distribution does not fit."""
        return self.p_value < DOUBTFUL


def goodness(found: Fit, refits: int, seed: int) -> Goodness:
    """Return the goodness of a fit, by so many simulated refits.

    Raises DataError for left or interval censored data, of which it is not known when somebody looked, and for parts
    that were not watched from new.
    """
    if len(found.data.since):
        raise DataError("a goodness of fit by simulation knows nothing of parts not watched from new")
    if np.any(found.data.failed & (found.data.low != found.data.high)):
        raise DataError("a goodness of fit by simulation needs to know when parts were looked at; intervals do not say")
    with asked(f"{found.data.source}: {found.name}"):
        result = library("diagnostics.univariate").bootstrap(found.model, refits, seed)
    return Goodness(float(result["observed"]["AD"]), float(result["p"]["AD"]))
