"""A life in cycles that a tenth do not reach, as makers state it:  λ = (−ln 0.9)^(1/β) / (B10 · Γ(1 + 1/β))

1/λ is the mean life of the Weibull distribution with that shape β; with β = 1 it is 0.105 / B10.
"""

from __future__ import annotations

from robophm.hazard.handbooks.general._b10 import NOTE, SHAPE, SOURCE, rate_of_b10
from robophm.hazard.model import Array, Factor, Range, hazard_model


@hazard_model(
    source=SOURCE,
    unit="1/cycle",
    inputs={
        "b10": Range(1.0, 1e15, "cycle", "cycles until a tenth have failed", monotone=-1),
        "shape": SHAPE,
        "source": NOTE,
    },
)
def hazard_rate(b10: Array, shape: Array, source: str) -> Factor:
    """λ = (−ln 0.9)^(1/β) / (B10 · Γ(1 + 1/β))"""
    return rate_of_b10(b10, shape, source)
