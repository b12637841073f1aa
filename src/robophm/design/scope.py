"""What a level of a design inherits from those above it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from robophm.design import schema
from robophm.design.driving import Ambient, Cover, ambient_of
from robophm.design.fault import Path


@dataclass(frozen=True)
class Scope:
    """What a level inherits from those above it."""

    environment: str | None = None
    signals: Mapping[str, tuple[Path, schema.SignalBinding]] = field(default_factory=dict)
    clocks: Mapping[str, tuple[Path, schema.ClockBinding]] = field(default_factory=dict)
    acceleration: schema.Accelerations | None = None
    uncertainty: tuple[Path, schema.Uncertainty] | None = None
    duty: float = 1.0
    ambient: Ambient | None = None
    quality: str | None = None

    def within(self, place: Path, level: Any) -> Scope:
        """What holds in a level of it: what the level states, else what it inherits."""
        return Scope(
            level.environment or self.environment,
            {**self.signals, **{name: ((*place, "signals", name), b) for name, b in level.signals.items()}},
            {**self.clocks, **{name: ((*place, "clocks", name), b) for name, b in level.clocks.items()}},
            level.acceleration if level.acceleration is not None else self.acceleration,
            ((*place, "uncertainty"), level.uncertainty) if level.uncertainty else self.uncertainty,
            self.duty if level.duty is None else level.duty,
            self.ambient if isinstance(level, schema.Component) else ambient_of(place, level, self.ambient),
            level.quality or self.quality,
        )

    def cover(self, part: schema.Component) -> Cover:
        """What of stresses a part in it has sensors of."""
        return Cover(self.signals, frozenset(part.signals), part.offsets, self.ambient)
