"""The figures of the 2020 tool for a robot beside the exact ones."""

from __future__ import annotations

import math
from dataclasses import dataclass

from robophm.design.importers.legacy.figures import reliability_at
from robophm.design.importers.legacy.reading import Imported
from robophm.health.plant import Plant
from robophm.health.when_new import nominal_figures

HOURS = 1000.0
"""Hours of operation at which figures are compared: those of the 2020 tool's guide."""


@dataclass(frozen=True)
class Comparison:
    """Failure rates [1/h] and reliabilities at so many hours of the system (empty path) or a module, exact when new.

    Without exact ones the module is left out of the design.
    """

    path: str
    legacy_stored: float | None
    legacy_hazard_rate: float
    legacy_reliability: float
    hazard_rate: float | None
    reliability: float | None
    unreliability: float | None


def comparisons(imported: Imported, hours: float = HOURS) -> list[Comparison]:
    """Return the comparison for the system, then for each of its modules."""
    exact: dict[str, tuple[float, float, float]] = {
        one.path: (one.hazard_rate, one.reliability, one.unreliability)
        for one in nominal_figures(Plant(imported.robot), hours)
    }
    for part in imported.robot.components:  # a module without parts of its own is one part
        rate = part.modes[0].rate
        exact[part.path] = rate, math.exp(-rate * hours), -math.expm1(-rate * hours)
    return [
        Comparison(
            figure.path,
            figure.stored,
            figure.recomputed,
            reliability_at(hours * 3600, figure.recomputed),
            *exact.get(figure.path, (None, None, None)),
        )
        for figure in imported.figures
    ]
