"""A signal that shows how worn a part is, as a design binds it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple


class Gauge(NamedTuple):
    """A signal as it is recorded. A value outside [low, high] is none; of a load it says that the load is another."""

    signal: str
    low: float
    high: float
    max_age: int
    """Nanoseconds that the last value holds."""


@dataclass(frozen=True)
class WearSignal:
    """A signal that shows how worn a part is, and how worn is too much."""

    gauge: Gauge
    unit: str | None
    """Unit of the signal's values; None: not known."""
    reading: Literal["mean", "rms", "kurtosis", "highest", "lowest"]
    """The statistic made of the samples of each stretch of time."""
    every: int
    """Length of a stretch of time [ns]."""
    ambient: Gauge | None
    """A gauge whose value is subtracted from each sample; None: nothing is."""
    load: Gauge | None
    """A gauge within whose range samples count; None: all count."""
    threshold: float
    """The threshold in the unit of the reading: the signal's; a kurtosis has none."""
    threshold_deviation: float = 0.0
    """Standard deviation of the threshold, in the same unit; 0: it is exactly known."""
    share: float = 1.0
    """Share of the hazard of its failure mode that the wear stands for; the rest comes by chance."""
    teachers: str | None = None
    """Name of a table, in the robot's ``folder``, with such readings of others of its kind; None: there is none."""

    @property
    def signals(self) -> tuple[str, ...]:
        """Return all signals that it is made of, each once."""
        return tuple(dict.fromkeys(one.signal for one in (self.gauge, self.ambient, self.load) if one))
