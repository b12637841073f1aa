"""Life–stress models: accelerated tests, fitted by SurPyval, to say how long a part lives at less stress.

ln life falls by a sum of terms, one for each stress: a life at stress x is that at the reference stress divided by
exp(Σ coefficient · z(x)). So Arrhenius, inverse power and their products are one regression; what a law has that is not
fitted (the kelvins of Eyring's) is a factor on the times. Steps of stress add up to one exposure (cumulative exposure,
Nelson 1980).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import chdtrc

from robophm.core.errors import DataError, nearest
from robophm.learning.life_data.distribution_fitting import (
    DOUBTFUL,
    FAMILIES,
    FAR,
    LEVEL,
    UNKNOWN,
    Bounded,
    Fit,
    as_theirs,
    fit,
)
from robophm.learning.life_data.observed_lives import LifeData
from robophm.learning.life_data.surpyval import asked, library
from robophm.life import life_distribution
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

BOLTZMANN = 8.617333262e-5  # eV/K
ZERO = 273.15  # K


class Law(NamedTuple):
    """The law by which life falls with one stress."""

    covariate: Callable[[Array, float], Array]
    """z of stress and reference stress; 0 at the reference."""
    coefficient: str
    unit: str
    acceleration: str
    """Name of the design's acceleration of that law."""
    known: Callable[[Array, float], Array] = lambda x, reference: np.ones(np.shape(x))
    """Factor on life that is not fitted."""
    read: Callable[[float], float] = lambda coefficient: coefficient
    """Converts the fitted coefficient to that of the law."""


def _arrhenius(x: Array, reference: float) -> Array:
    return 1 / (BOLTZMANN * (reference + ZERO)) - 1 / (BOLTZMANN * (x + ZERO))


LAWS: Mapping[str, Law] = {
    "arrhenius": Law(_arrhenius, "activation_energy", "eV", "arrhenius"),
    "eyring": Law(
        _arrhenius, "activation_energy", "eV", "eyring", lambda x, reference: (x + ZERO) / (reference + ZERO)
    ),
    "q10": Law(lambda x, reference: (x - reference) / 10, "q", "", "q10", read=math.exp),
    "inverse_power": Law(lambda x, reference: np.log(x / reference), "exponent", "", "inverse_power"),
}
"""The laws by name; the first three are of temperature [°C]."""

OF_TEMPERATURE = ("arrhenius", "eyring", "q10")
_BASES = ("exponential", "weibull", "lognormal", "gamma", "loglogistic")


@dataclass(frozen=True)
class LifeStressFit:
    """A life distribution at the reference stress, and how it shrinks with stress."""

    name: str
    data: LifeData
    laws: Mapping[str, str]
    """Law of each stress."""
    reference: Mapping[str, float]
    level: float
    coefficients: Mapping[str, Bounded]
    """Coefficient of each stress, as its law calls it."""
    parameters: Mapping[str, Bounded]
    """Parameters of life at the reference stress."""
    life: LifeDistribution
    log_likelihood: float
    aic: float
    quantiles: Mapping[float, Bounded]
    """Quantiles of life at the reference stress."""
    levels: tuple[tuple[Mapping[str, float], int, int, float, Fit | None], ...]
    """Each stress that was tested: what it was, parts, failures, acceleration, and a fit of it alone if it has one."""
    separate: tuple[float, int, float] | None
    """Likelihood ratio of lives fitted at each stress alone over this, its degrees of freedom, and p."""
    covariance: Array
    steps: bool = False
    """Whether stress was raised in steps."""
    notes: tuple[str, ...] = ()

    @property
    def known_until(self) -> float:
        """The life at the reference stress beyond which the data tell nothing of a figure."""
        return UNKNOWN * self.data.longest * max(*self._tested(), 1.0)

    @property
    def nearest_test(self) -> float:
        """The acceleration of the test that was nearest to the reference stress."""
        return min(self._tested(), key=lambda factor: abs(math.log(max(factor, 1e-300))))

    def _tested(self) -> list[float]:
        table = np.unique(np.stack(list(self.data.stresses.values()), axis=1), axis=0)
        return [self.acceleration(dict(zip(self.data.stresses, one, strict=True))) for one in table.tolist()]

    def acceleration(self, stress: Mapping[str, float]) -> float:
        """Return how many times as fast a part ages at a stress as at the reference."""
        factor = 0.0
        for name, law in self.laws.items():
            x, reference = np.array(stress[name]), self.reference[name]
            coefficient = self.coefficients[name].value
            raw = math.log(coefficient) if law == "q10" else coefficient
            factor += raw * float(LAWS[law].covariate(x, reference)) + math.log(float(LAWS[law].known(x, reference)))
        return math.exp(factor)


def fit_life_stress(
    data: LifeData, name: str = "weibull", *, reference: Mapping[str, float], laws: Mapping[str, str] | None = None,
    level: float = LEVEL,
) -> LifeStressFit:  # fmt: skip
    """Fit lives at several stresses. ``reference``: the stress of use, of each that the data state.

    ``laws`` by stress; else Arrhenius of temperature and inverse power of any other. Lives may be known within
    intervals. Where an item has several rows they are its steps, each ending at its ``time``, and failures are at known
    times. Raises DataError, in words, where the data do not support it.
    """
    chosen = _laws(data, name, reference, laws or {})
    steps = data.items_repeat
    z, known = _covariates(data, chosen, reference)
    _supported(data, z, name, steps=steps)
    family, sp = FAMILIES[name], library()
    with asked(f"{data.source}: {name} life at stress") as said:
        fitter = sp.AFT(getattr(sp, family.theirs))
        if steps:
            model = fitter.fit_tvc(**_steps(data, z, known))
        else:
            since = data.since * known if len(data.since) else data.since
            sped = replace(data, low=data.low * known, high=data.high * known, since=since)
            model = fitter.fit(Z=z, **as_theirs(sped))
        found = _found(data, name, chosen, reference, level, model)
    tested, separate = ((), None) if steps else _levels(data, name, found)
    notes = list(dict.fromkeys(said))[:3]
    for stress, one in found.coefficients.items():
        if one.value <= (1 if chosen[stress] == "q10" else 0):
            notes.append(f"life grows with {stress}: that is no acceleration")
        elif one.low <= (1 if chosen[stress] == "q10" else 0):
            notes.append(f"that {stress} shortens life is not shown: the interval holds none")
    if not 1 / FAR <= found.nearest_test <= FAR:
        notes.append(f"even the nearest test aged parts {found.nearest_test:.3g} times as fast as use: figures of use "
                     "rest on the law alone")  # fmt: skip
    if separate and separate[2] < DOUBTFUL:
        notes.append("one law with one shape for all stresses fits badly: lives at each stress alone fit better")
    return replace(found, steps=steps, levels=tested, separate=separate, notes=tuple(notes))


def _laws(data: LifeData, name: str, reference: Mapping[str, float], laws: Mapping[str, str]) -> dict[str, str]:
    if name not in _BASES:
        raise DataError(f"a {name} life does not shrink with stress in proportion; expected {', '.join(_BASES)}")
    if not data.stresses:
        raise DataError(f"{data.source}: states no stress; expected a column such as 'temperature [degC]'")
    for stress in (*reference, *laws):
        if stress not in data.stresses:
            raise DataError(f"{data.source}: has no stress '{stress}'{nearest(stress, data.stresses)}")
    chosen = {}
    for stress, values in data.stresses.items():
        if stress not in reference:
            raise DataError(f"{data.source}: at which {stress} will parts be used? expected a stress of use")
        law = laws.get(stress, "arrhenius" if stress == "temperature" else "inverse_power")
        if law not in LAWS:
            raise DataError(f"no law '{law}'{nearest(law, LAWS)}")
        if (law in OF_TEMPERATURE) != (stress == "temperature") and law != "inverse_power":
            raise DataError(f"{law} is a law of temperature, not of {stress}; expected inverse_power")
        if law == "inverse_power" and (values.min() <= 0 or reference[stress] <= 0):
            raise DataError(f"{data.source}: {stress} of 0 or less has no power law; expected above 0")
        if law in OF_TEMPERATURE and reference[stress] <= -ZERO:
            raise DataError(f"a {stress} of {reference[stress]:g} degC is below absolute zero")
        chosen[stress] = law
    return chosen


def _covariates(data: LifeData, laws: Mapping[str, str], reference: Mapping[str, float]) -> tuple[Array, Array]:
    """z of each row and stress, shape (rows, stresses); and the factor on times that no law fits."""
    z = np.stack([LAWS[law].covariate(data.stresses[one], reference[one]) for one, law in laws.items()], axis=1)
    known = np.ones(len(data.low))
    for one, law in laws.items():
        known = known * LAWS[law].known(data.stresses[one], reference[one])
    return z, known


def _supported(data: LifeData, z: Array, name: str, *, steps: bool) -> None:
    failed = data.failed
    if data.modes:
        raise DataError(f"{data.source}: failure modes at stress are fitted one by one; expected a table of each mode")
    if steps and len(data.since):
        raise DataError(f"{data.source}: steps of stress are of parts watched from new; expected no column 'since'")
    if data.failures < z.shape[1] + 2:
        raise DataError(
            f"{data.source}: {data.failures} failures for {z.shape[1] + 2} parameters; expected at least that many"
        )
    for stress in data.stresses:
        if len(np.unique(data.stresses[stress][failed])) < 2:
            raise DataError(
                f"{data.source}: failures at only one {stress}: how life changes with it cannot be told; expected "
                "failures at two or more"
            )
    design = np.column_stack((np.ones(int(failed.sum())), z[failed]))
    if np.linalg.matrix_rank(design, tol=1e-8 * max(float(np.abs(design).max()), 1.0)) < design.shape[1]:
        raise DataError(
            f"{data.source}: its stresses go up and down together: which of {', '.join(data.stresses)} shortens life "
            "cannot be told; expected tests that change one alone"
        )
    levels = [np.all(z == one, axis=1) for one in np.unique(z, axis=0)]
    apart = any(data.low[rows].max() > data.high[rows].min() for rows in levels)
    if name != "exponential" and not steps and not apart and len(levels) <= design.shape[1]:
        raise DataError(
            f"{data.source}: at each stress one moment explains all lives: how far they spread cannot be told; "
            "expected two at one stress that part, or one stress more"
        )


def _steps(data: LifeData, z: Array, known: Array) -> dict[str, Any]:
    """Rows as stretches of an item's life, on clocks that the known factors speed up."""
    number = {item: i for i, item in enumerate(dict.fromkeys(data.items))}
    start: list[float] = []
    begun: list[float] = []
    last: dict[str, tuple[float, float, bool]] = {}
    for row, item in enumerate(data.items):
        before, clock, over = last.get(item, (0.0, 0.0, False))
        at = float(data.low[row])
        if over:
            raise DataError(f"{data.source}: '{item}' goes on after it failed; expected its failure in its last step")
        if not at > before:
            raise DataError(f"{data.source}: '{item}' has steps that end at {before:g} and then {at:g}; expected later")
        if data.count[row] != 1 or (data.failed[row] and data.low[row] != data.high[row]):
            raise DataError(
                f"{data.source}: steps are of one part each, which fails at a known time or does not (SurPyval's "
                "likelihood of steps has no intervals); expected one time in each row, or fixed stresses"
            )
        ends = clock + (at - before) * float(known[row])
        start.append(clock)
        begun.append(ends)
        last[item] = (at, ends, bool(data.failed[row]))
    return {
        "i": np.array([number[item] for item in data.items]), "xl": np.array(start), "xr": np.array(begun),
        "c": np.where(data.failed, 0, 1), "Z": z,
    }  # fmt: skip


def _found(
    data: LifeData, name: str, laws: Mapping[str, str], reference: Mapping[str, float], level: float, model: Any
) -> LifeStressFit:
    family, tail = FAMILIES[name], 1 - level
    values = dict(zip(model.parameter_names, (float(one) for one in model.params), strict=True))
    if not all(map(math.isfinite, values.values())):
        raise DataError(f"{data.source}: no best fit; expected failures that spread more over the stresses")

    def bounded(theirs: str) -> tuple[float, float, float]:
        low, high = (float(end) for end in model.param_cb(theirs, alpha_ci=tail))
        return values[theirs], low, high

    parameters = {}
    for ours, (theirs, inverse) in family.parameters.items():
        value, low, high = bounded(theirs)
        parameters[ours] = Bounded(1 / value, 1 / high, 1 / low) if inverse else Bounded(value, low, high)
    coefficients = {
        stress: Bounded(*(LAWS[law].read(end) for end in bounded(f"coef_{k}")))
        for k, (stress, law) in enumerate(laws.items())
    }
    life = life_distribution(family.ours)(**{ours: one.value for ours, one in parameters.items()})
    at = np.zeros((1, len(laws)))
    levels = (0.01, 0.1, 0.5, 0.9)
    ends = np.asarray(model.quantile_cb(list(levels), Z=at, alpha_ci=tail)).reshape(-1, 2)
    quantiles = {
        p: Bounded(float(life.quantile(p)), float(low), float(high))
        for p, (low, high) in zip(levels, ends, strict=True)
    }
    log_likelihood = -float(model.neg_ll())
    jacobian = float(sum(_log_known(data, laws, reference)))  # of the times that were speeded up by what is known
    free = len(values)
    return LifeStressFit(
        name, data, laws, dict(reference), level, coefficients, parameters, life, log_likelihood + jacobian,
        2 * free - 2 * (log_likelihood + jacobian), quantiles, (), None, np.asarray(model.covariance()),
    )  # fmt: skip


def _log_known(data: LifeData, laws: Mapping[str, str], reference: Mapping[str, float]) -> Array:
    _, known = _covariates(data, laws, reference)
    return np.where(data.low == data.high, data.count * np.log(known), 0.0)


def _levels(
    data: LifeData, name: str, found: LifeStressFit
) -> tuple[tuple[tuple[Mapping[str, float], int, int, float, Fit | None], ...], tuple[float, int, float] | None]:
    """A fit of each stress alone, and the likelihood ratio test of all of them together against the common fit."""
    table = np.stack(list(data.stresses.values()), axis=1)
    tested, total, parameters = [], 0.0, 0
    for combination in np.unique(table, axis=0):
        rows = np.all(table == combination, axis=1)
        stress = dict(zip(data.stresses, (float(one) for one in combination), strict=True))
        since = data.since[rows] if len(data.since) else data.since
        part = LifeData(data.source, data.low[rows], data.high[rows], data.count[rows], data.unit, since=since)
        alone: Fit | None = None
        if part.failures >= 2:
            try:
                alone = fit(part, name, level=found.level)
                total, parameters = total + alone.log_likelihood, parameters + len(found.parameters)
            except DataError:
                alone = None
        tested.append((stress, part.parts, part.failures, found.acceleration(stress), alone))
    if len(tested) < 2 or any(one[4] is None for one in tested):
        return tuple(tested), None
    freedom = parameters - len(found.parameters) - len(found.coefficients)
    if freedom <= 0:
        return tuple(tested), None
    ratio = max(0.0, 2 * (total - found.log_likelihood))
    return tuple(tested), (ratio, freedom, float(chdtrc(freedom, ratio)))
