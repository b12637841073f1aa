"""The future of one failure mode by its wear, in the place of its own hazard.

The mode works now: its sensor says so. In a share 1 − ν of what is foretold its wear reaches the threshold, by a
cumulative hazard Λ; in the rest, ν, it never does, and the mode goes by its own hazard H, of which nothing else is
known. So it survives with (1 − ν)·exp(−Λ) + ν·exp(−H).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from robophm.health.foretold_life import ForetoldLife

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class WearToCome:
    """The wear of one failure mode from now on; times are of the clock of its readings."""

    life: ForetoldLife
    """Life from the last reading to the threshold, where that is reached."""
    never: float
    """Probability ν, at the last reading, that it never is."""
    since: float
    """Time since the last reading."""
    rate: float
    """Age, as the mode's life counts it, that a unit of that time adds."""
    share: float = 1.0
    """Share of the mode's own hazard that the wear stands for; the rest comes by chance beside it."""
    doubted: bool = False
    """Whether no model follows the wear: then all of the mode's own hazard stays beside it, for safety."""

    @property
    def stays(self) -> float:
        """Return the share of the mode's own hazard that comes beside its wear."""
        return 1.0 if self.doubted else 1.0 - self.share

    @cached_property
    def unseen_hazard(self) -> float:
        """Return the cumulative hazard since the last reading, which said that the mode worked."""
        return float(-np.log1p((1 - self.never) * np.expm1(-self.life.cumulative_hazard(self.since))))

    @cached_property
    def _never(self) -> float:
        """ν now: since the last reading it has not come to the threshold."""
        return float(min(self.never * np.exp(self.unseen_hazard), 1.0))

    def added(self, own: Array, begun: Array, step: Array) -> Array:
        """Return the cumulative hazard that steps that follow one another add; shape (steps, ...), that of ``own``.

        ``own``: what they add by its own hazard; ``begun``: how far it had aged by their beginning; ``step``: in them.
        """
        worn = np.asarray(self.life.increment(self.since + begun / self.rate, step / self.rate))
        if self._never > 0:
            by_itself = self.share * own
            before = np.zeros_like(by_itself)
            np.cumsum(by_itself[:-1], axis=0, out=before[1:])
            wears, stays = self._shares(begun, before)
            with np.errstate(divide="ignore", invalid="ignore"):
                little = -np.log1p(wears * np.expm1(-worn) + stays * np.expm1(-by_itself))
                much = -np.logaddexp(np.log(wears) - worn, np.log(stays) - by_itself)
            worn = np.where(np.minimum(worn, by_itself) < 1.0, little, much)
        result: Array = worn + self.stays * own if self.stays else worn  # of which ``own`` may be infinite
        return result

    def hazard(self, own: Array, lived: Array, gone: Array, speed: Array) -> Array:
        """Return the hazard rate after ageing so far, at a speed then [per hour of operation]; shape of ``own``.

        ``own``: by its own hazard, and ``lived`` what that has gathered from now till then.
        """
        rate = np.asarray(self.life.hazard(self.since + gone / self.rate)) * speed / self.rate
        if self._never > 0:
            wears, stays = self._shares(gone, self.share * lived)
            rate = wears * rate + stays * self.share * own
        result: Array = rate + self.stays * own if self.stays else rate
        return result

    def _shares(self, gone: Array, lived: Array) -> tuple[Array, Array]:
        """P(its wear comes to the threshold), P(it never does), after ageing so far; ``lived`` by its own hazard."""
        worn = np.asarray(self.life.increment(self.since, gone / self.rate))
        # As odds, so that neither is lost where survival itself is too small for a number.
        odds = np.log(self._never) - np.log1p(-self._never) - lived + worn if self._never < 1 else np.full(1, np.inf)
        return 1 / (1 + np.exp(np.minimum(odds, 700.0))), 1 / (1 + np.exp(np.minimum(-odds, 700.0)))
