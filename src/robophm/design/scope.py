"""The settings that a level of a design inherits from those above it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from robophm.design import schema
from robophm.design.located_error import Path
from robophm.design.sensor_inputs import Ambient, SensorCover, ambient_of


@dataclass(frozen=True)
class Scope:
    """The settings that hold in a level: its own, and those inherited from above."""

    environment: str | None = None
    signals: Mapping[str, tuple[Path, schema.SignalBinding]] = field(default_factory=dict)
    clocks: Mapping[str, tuple[Path, schema.ClockBinding]] = field(default_factory=dict)
    acceleration: schema.Accelerations | None = None
    uncertainty: tuple[Path, schema.Uncertainty] | None = None
    duty: float = 1.0
    ambient: Ambient | None = None
    quality: tuple[Path, str] | None = None
    repair: float = math.inf
    """Mean time [h] until a part that has failed is as good as new; infinite: it stays failed."""
    identity: str = ""
    """Path under which the past of what is here is kept; "" for the robot, whose parts' paths begin below it."""

    def within(self, place: Path, level: Any) -> Scope:
        """Return the scope of a level inside this one: what that states, else what it inherits."""
        identity = level.identity or f"{self.identity}/{place[-1]}".lstrip("/") if place else ""
        return Scope(
            level.environment or self.environment,
            {**self.signals, **{name: ((*place, "signals", name), b) for name, b in level.signals.items()}},
            {**self.clocks, **{name: ((*place, "clocks", name), b) for name, b in level.clocks.items()}},
            level.acceleration if level.acceleration is not None else self.acceleration,
            ((*place, "uncertainty"), level.uncertainty) if level.uncertainty else self.uncertainty,
            self.duty if level.duty is None else level.duty,
            self.ambient if isinstance(level, schema.Component) else ambient_of(place, level, self.ambient),
            (place, level.quality) if level.quality else self.quality,
            {None: self.repair, "none": math.inf}.get(level.repair, level.repair),
            identity,
        )

    def cover(self, part: schema.Component) -> SensorCover:
        """Return the sensors that a part in this scope has of its stresses."""
        return SensorCover(self.signals, frozenset(part.signals), part.offsets, self.ambient)
