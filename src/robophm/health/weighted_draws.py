"""Groups of units under rates that are drawn: what gathers in them, and how much each draw counts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from robophm.health.drawn_rates import drawn_together
from robophm.health.plant import Modes, Parts
from robophm.health.prognosis import Outlook

Array = npt.NDArray[np.float64]

_HUGE = 1e300  # stands for an infinite hazard, where infinity times a ratio of 0 would not
_FEWEST_EFFECTIVE = 0.2  # of the draws, below which they are drawn by what is known of each part


class DrawnRates:
    """Groups of units under drawn rates: what gathers in them, and how much each draw counts.

    Where a cumulative hazard is a power of age, θ·u for u is a constant factor: θ^β, for the past and for any future.
    """

    def __init__(
        self, outlook: Outlook, parts: Parts, needed: npt.NDArray[np.bool_], ratios: Array, futures: int,
        log_works: Callable[[Array], Array],
    ) -> None:  # fmt: skip
        m, ratios = parts.modes, ratios[parts.modes]
        # What wear adds no rate scales: its modes are not among those whose hazard is a factor times that as stated.
        degrees = [None if i in outlook.worn else outlook.plant.robot.modes[i].life.degree for i in m.tolist()]
        self._is_power = np.array([degree is not None for degree in degrees])
        weights = parts.weights
        self._weights, self._of_groups = weights[:, : len(m)], weights[:, len(m) :]
        # The members of groups of dependent parts have rates that are exact.
        exact = np.repeat(outlook.groups_till_now(parts)[:, None], ratios.shape[1], axis=1)
        self.scaling, self.others = (Modes(outlook.plant, m[which]) for which in (self._is_power, ~self._is_power))
        """The modes whose hazard the rate scales, and the others."""
        scale = np.array([row**degree for row, degree in zip(ratios, degrees, strict=True) if degree is not None])
        lived, unseen = np.empty_like(ratios), np.empty_like(ratios)
        if self._is_power.any():
            lived[self._is_power] = scale * outlook.cumulative_hazard[self.scaling.modes, None]
            unseen[self._is_power] = scale * outlook.unseen_hazard[self.scaling.modes, None]
        if not self._is_power.all():
            lived[~self._is_power], unseen[~self._is_power] = _past(outlook, self.others, ratios[~self._is_power])
        worn = np.isin(m, list(outlook.worn))
        unseen[worn] = outlook.unseen_hazard[m[worn], None]
        # What each unit tells of its own modes alone.
        first = outlook.known(parts, needed, parts.of_units(np.vstack((unseen, exact))[:, :1]))[:, 0]
        failed = np.isinf(first)
        working, unknown = (
            parts.of_modes((which & ~failed).astype(float))[: len(m), None] for which in (first == 0, first > 0)
        )
        evidence = -working * lived - unknown * (lived - unseen)
        alone = evidence.sum(axis=0)
        if _effective(alone) < _FEWEST_EFFECTIVE * len(alone):  # together they leave few draws: draw by each instead
            unsure = np.flatnonzero(np.ptp(ratios, axis=1) > 0)
            for together in drawn_together(outlook.plant.robot, m[unsure].tolist()):
                modes = unsure[together].tolist()
                chosen = _resampled(evidence[modes].sum(axis=0))
                for rows in (ratios, lived, unseen):
                    rows[modes] = rows[modes][:, chosen]
                for row in np.cumsum(self._is_power)[modes][self._is_power[modes]] - 1:
                    scale[row] = scale[row, chosen]
            alone = np.zeros_like(alone)
        lived, unseen = (parts.of_units(np.vstack((one, exact))) for one in (lived, unseen))
        known = outlook.known(parts, needed, unseen)
        self.known = parts.of_groups(known)
        """Cumulative hazard of each group, less what is known not to have happened; shape (groups, draws)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            total = alone + log_works(self.known)
            if failed.any():  # since it was last seen to work
                total = total + (unseen - lived + np.log(-np.expm1(-unseen)))[failed].sum(axis=0)
        top = np.max(total)
        weight = np.exp(total - top) if np.isfinite(top) else np.ones(len(total))
        self.weight: Array = weight / weight.sum()
        """Probability of each draw, given what is known; shape (draws,)."""
        # The first draws have the first future, the next have the next, and so on.
        self._scale = np.array_split(scale.reshape(-1, len(weight)), futures, axis=1)
        self.ratios = np.array_split(ratios[~self._is_power], futures, axis=1)
        """Ratios of the other modes in the draws of each future."""

    def gathered(self, stated: Sequence[Array], others: Sequence[Array], dependent: Sequence[Array]) -> Array:
        """Return the cumulative hazard that steps add to each group; shape (groups, steps, draws).

        For each future: to the modes that scale, at ``stated`` rates, shape (modes, steps); and to the ``others``
        under its draws, shape (modes, steps, draws); and to groups of ``dependent`` parts, shape (groups, steps).
        """
        scaling, rest = self._weights[:, self._is_power], self._weights[:, ~self._is_power]
        groups, steps = scaling.shape[0], stated[0].shape[1]
        # One row for each step and group: the rates of a group add up before they meet the draws.
        columns = np.tile(scaling.indices, steps)
        starts = np.append((scaling.indptr[:-1] + scaling.nnz * np.arange(steps)[:, None]).ravel(), len(columns))
        found = []
        for scale, one, other, group in zip(self._scale, stated, others, dependent, strict=True):
            entries = scaling.data * np.minimum(one, _HUGE)[scaling.indices].T
            rates = csr_array((entries.ravel(), columns, starts), shape=(steps * groups, len(one)))
            sums = np.moveaxis((rates @ scale).reshape(steps, groups, scale.shape[1]), 0, 1)
            if len(other):
                sums = sums + (rest @ other.reshape(len(other), -1)).reshape(sums.shape)
            if len(group):
                sums = sums + (self._of_groups @ group)[..., None]
            found.append(sums)
        return np.concatenate(found, axis=2) if len(found) > 1 else found[0]


def _effective(evidence: Array) -> float:
    """Kish's effective number of equally likely draws, from the logarithms of their probabilities."""
    top = np.max(evidence)
    weight = np.exp(evidence - top) if np.isfinite(top) else np.ones(len(evidence))
    return float(weight.sum() ** 2 / np.sum(weight**2))


def _resampled(evidence: Array) -> npt.NDArray[np.intp]:
    """Indices of draws, each as often as its evidence [ln of a probability] is worth: systematic resampling.

    Source: Kitagawa (1996)."""
    top, count = np.max(evidence), len(evidence)
    if not np.isfinite(top):
        return np.arange(count)
    reached = np.cumsum(np.exp(evidence - top))
    chosen: npt.NDArray[np.intp] = np.searchsorted(reached, (np.arange(count) + 0.5) / count * reached[-1])
    return chosen


def _past(outlook: Outlook, modes: Modes, ratios: Array) -> tuple[Array, Array]:
    """Cumulative hazard of modes under drawn rates, since new and since last seen; shape (modes, draws)."""
    m = modes.modes
    age, seen = outlook.age[m, None], outlook.seen_age[m, None]
    lived = modes.lives.increment(np.zeros((1, 1)), ratios * age)
    unseen = modes.lives.increment(ratios * seen, ratios * np.maximum(age - seen, 0.0))
    by_hazard = ~outlook.plant.by_age[m]
    if by_hazard.any():  # their past is a sum, which the rate scales as it would have under design stress
        stated = modes.lives.increment(np.zeros((1, 1)), age)
        scale = np.divide(lived, stated, out=ratios.copy(), where=stated > 0)
        lived[by_hazard] = (scale * outlook.cumulative_hazard[m, None])[by_hazard]
        unseen[by_hazard] = (scale * outlook.unseen_hazard[m, None])[by_hazard]
    return lived, unseen
