"""A rate somebody states: a maker, a test, the field. The design says who."""

from __future__ import annotations

from robophm.core.table import Source
from robophm.hazard.model import Array, Factor, Note, Range, hazard_model


@hazard_model(
    source=Source("the user's own figure", "–", "–", "as stated in the design"),
    inputs={
        "rate": Range(0.0, 1e6, "1/h", "hazard rate"),
        "source": Note("who states it", required=False),
    },
)
def hazard_rate(rate: Array, source: str | None = None) -> Factor:
    """λ as stated."""
    return Factor("λ", rate, source or "stated in the design")
