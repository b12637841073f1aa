"""Prognostic analysis: how often a list of tasks can be done again."""

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
    """Of completion; shape (repetitions,)."""
    failure: Array
    """Their complements, with their own digits."""
    asked: int
    """How many repetitions were asked for."""

    @classmethod
    def of(cls, chunks: Iterable[Array], asked: int) -> RepeatedTasks:
        """What ``mission.repetitions`` yields, all of it or as much as somebody waited for, put together."""
        probability, failure = np.concatenate([np.empty((2, 0)), *chunks], axis=1)
        return cls(probability, failure, asked)

    @property
    def cut_short(self) -> bool:
        """Whether there are fewer than were asked for."""
        return len(self.probability) < self.asked

    def first_below(self, threshold: float) -> int | None:
        """The first repetition, from 1, that is less likely to be completed than that; None where none is."""
        below = np.flatnonzero(self.probability < threshold)
        return int(below[0]) + 1 if len(below) else None

    @property
    def together(self) -> Completion:
        """That all of these repetitions are completed."""
        with np.errstate(divide="ignore"):
            hazard = -np.sum(np.where(self.failure < 0.5, np.log1p(-self.failure), np.log(self.probability)))
        return Completion(float(np.exp(-hazard)), float(-np.expm1(-hazard)))
