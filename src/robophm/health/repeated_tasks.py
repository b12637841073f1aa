"""Prognostic analysis: how often in a row a list of tasks can be completed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.health.mission import Completion

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class RepeatedTasks:
    """A list of tasks one time after the other: whether each repetition is completed, given that all before it were."""

    probability: Array
    """Probability that each repetition is completed; shape (repetitions,)."""
    failure: Array
    """Complements of the probabilities, with their own digits."""
    asked: int
    """Number of repetitions that were asked for."""

    @classmethod
    def of(cls, chunks: Iterable[Array], asked: int) -> RepeatedTasks:
        """Join the chunks that ``mission.repetitions`` yields, all of them or those that were waited for."""
        probability, failure = np.concatenate([np.empty((2, 0)), *chunks], axis=1)
        return cls(probability, failure, asked)

    @property
    def cut_short(self) -> bool:
        """Whether there are fewer repetitions than were asked for."""
        return len(self.probability) < self.asked

    def first_below(self, threshold: float) -> int | None:
        """Return the first repetition, from 1, that is less likely to be completed than ``threshold``, or None."""
        below = np.flatnonzero(self.probability < threshold)
        return int(below[0]) + 1 if len(below) else None

    @property
    def together(self) -> Completion:
        """Return the probability that all of these repetitions are completed."""
        with np.errstate(divide="ignore"):
            hazard = -np.sum(np.where(self.failure < 0.5, np.log1p(-self.failure), np.log(self.probability)))
        return Completion(float(np.exp(-hazard)), float(-np.expm1(-hazard)))
