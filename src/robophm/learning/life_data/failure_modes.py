"""Parts that fail in several ways: each mode's life with the others' failures taken as censored, and their product.

What is first to fail ends the part: if modes do not depend on each other, its survival is the product of theirs
(competing risks; Meeker and Escobar, Statistical Methods for Reliability Data, 1998, §15.4.2). That they do not cannot
be told from lives that end with the first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from robophm.core.errors import DataError, ModelError, nearest
from robophm.core.root import root
from robophm.design.file import load, read
from robophm.learning.failure_mode_edits import edited
from robophm.learning.life_data.distribution_fitting import LEVEL, UNKNOWN, Array, Fit, fit, fit_all, supports
from robophm.learning.life_data.fit_in_design import design_keys
from robophm.learning.life_data.observed_lives import LifeData


@dataclass(frozen=True)
class ModesFit:
    """Each failure mode of a part, and the part."""

    data: LifeData
    modes: Mapping[str, Fit]
    """The fit of each failure mode by its name, the most frequent first."""
    shares: Mapping[str, float]
    """P(it is the first), of parts that all go on until they fail."""
    quantiles: Mapping[float, float]
    """Quantiles of the part's life, by the share that has failed; infinite where so many never fail."""
    mean: float
    notes: tuple[str, ...] = ()

    @property
    def known_until(self) -> float:
        """The age beyond which the data tell nothing of a figure."""
        return UNKNOWN * max(self.data.longest, *(one.known_until / UNKNOWN for one in self.modes.values()))

    def survival(self, times: Array) -> Array:
        """P(the part works at an age); the product of its modes'."""
        return np.asarray(np.exp(-self._gathered(times)))

    def _gathered(self, times: Array) -> Array:
        return np.asarray(sum(np.asarray(one.life.increment(0.0, times)) for one in self.modes.values()))


def fit_modes(data: LifeData, name: str | None = None, *, level: float = LEVEL) -> ModesFit:
    """Fit a distribution to each failure mode, with the other modes' failures as censored.

    ``name`` is the distribution; None takes the best for each, and an exponential one where a mode has but one failure.

    Raises DataError where a mode cannot be fitted.
    """
    if data.items_repeat:
        supports(data, name or "weibull")  # says why not
    names = sorted({one for one in data.modes if one}, key=lambda one: (-_of(data, one).failures, one))
    if not names:
        supports(data, name or "weibull")
    modes, notes = {}, []
    for mode in names:
        own = _of(data, mode)
        try:
            if own.failures == 1 and name is None:
                modes[mode] = fit(own, "exponential", level=level)
                notes.append(f"{mode}: one failure tells no shape; a constant rate is taken")
            else:
                modes[mode] = fit(own, name, level=level) if name else fit_all(own, level=level)[0][0]
        except (DataError, ModelError) as error:
            said = str(error).removeprefix(f"{own.source}: ")
            raise DataError(f"{own.source}: {said}") from None
        notes += [f"{mode}: {note}" for note in modes[mode].notes]
    if np.any(data.failed & (data.low != data.high)):
        notes.append("of failures within intervals other modes are known to have worked until the interval began")
    found = ModesFit(data, modes, {}, {}, math.nan, tuple(notes))
    quantiles = {p: _quantile(found, p) for p in (0.01, 0.1, 0.5, 0.9)}
    end = _quantile(found, 1 - 1e-10)
    times = np.concatenate([[0.0], np.geomspace(1e-12, 1.0, 8001) * min(end, 1e300)])
    survival = found.survival(times)
    between = (survival[1:] + survival[:-1]) / 2
    mean = float(np.sum(between * np.diff(times))) if math.isfinite(end) else math.inf
    shares = {
        mode: float(np.sum(between * np.diff(np.asarray(one.life.increment(0.0, times)))))
        for mode, one in modes.items()
    }  # fmt: skip
    return replace(found, quantiles=quantiles, mean=mean, shares=shares)


def _of(data: LifeData, mode: str) -> LifeData:
    """Lives as one mode sees them: where another ended them, censored then."""
    own = np.array([one == mode for one in data.modes])
    high = np.where(data.failed & ~own, np.inf, data.high)
    kept = (high < np.inf) | (data.low > data.began)
    since = data.since[kept] if len(data.since) else data.since
    return LifeData(
        f"{data.source} ({mode})", data.low[kept], high[kept], data.count[kept], data.unit, {},
        tuple(item for item, is_ in zip(data.items, kept, strict=True) if is_) if data.items else (), since,
    )  # fmt: skip


def _quantile(found: ModesFit, share: float) -> float:
    wanted = -math.log1p(-share)

    def short(log_time: float) -> float:
        return min(float(found._gathered(np.array(math.exp(log_time)))), 1e300) - wanted

    low, high = math.log(1 / found.data.longest) - 60, math.log(found.data.longest) + 200
    return math.exp(root(short, low, high)) if short(low) < 0 < short(high) else math.inf


def edited_modes(found: ModesFit, design: Path, part: str) -> str:
    """The text of a design with the life of each failure mode of a part, by its name; nothing is written.

    Raises DesignError, and DataError where the design's part has no mode of a name.
    """
    robot = load(design)
    known = {mode.path: mode for mode in robot.modes if mode.path.rpartition("/")[0] == part}
    changes = {}
    for name, one in found.modes.items():
        path = f"{part}/{name}"
        if path not in known:
            raise DataError(f"'{part}' has no failure mode '{name}'{nearest(path, known)}; expected it in the design, "
                            "under failure_modes")  # fmt: skip
        changes[path] = design_keys(one, known[path])
    return edited(read(design), str(design), changes)
