"""Limits of health, and of what signals may say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields


@dataclass(frozen=True)
class Level:
    """A limit of a figure or a signal, in the unit that it has inside, and what an alarm on it waits for."""

    limit: float
    clear: float
    """Value at which an alarm ends; beyond the limit on the good side, or the limit itself."""
    delay: int = 0
    """Nanoseconds that it must last before there is an alarm."""


@dataclass(frozen=True)
class SignalLimits:
    """Limits of what a signal may say, in the unit of its messages' values."""

    above: Level | None = None
    below: Level | None = None


@dataclass(frozen=True)
class Limits:
    """Limits of health: λ at most [1/h], R and PoTC at least, median RUL at least [h]; None: not limited."""

    hazard_rate: Level | None = None
    reliability: Level | None = None
    remaining_life: Level | None = None
    completion: Level | None = None
    signals: Mapping[str, SignalLimits] = field(default_factory=dict)
    """Limits of signals by their names; of the robot alone."""

    @property
    def stated(self) -> bool:
        """Whether any of the limits is stated."""
        return any(getattr(self, limit.name) for limit in fields(Limits))


@dataclass(frozen=True)
class Thresholds(Limits):
    """Limits beyond which health is no longer good enough, and those beyond which attention is due."""

    warning: Limits = field(default_factory=Limits)
    survival: float | None = None
    """Value of survival ahead: remaining life is also stated as the time when survival falls to it; not a limit."""

    @property
    def limited(self) -> bool:
        """Whether any limit is stated, of an error or a warning."""
        return self.stated or self.warning.stated


NO_LIMITS = Thresholds()
"""The thresholds of what states none."""
