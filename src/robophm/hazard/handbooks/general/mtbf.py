"""A mean time between failures that a maker states:  λ = 1 / MTBF"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source
from robophm.hazard.model import Array, Factor, Note, Range, hazard_model


@hazard_model(
    source=Source("a maker's figure", "–", "–", "as stated in the design"),
    inputs={
        "mtbf": Range(1e-3, 1e12, "h", "mean time between failures, or to failure", monotone=-1),
        "source": Note("who states it, and for which conditions"),
    },
)
def hazard_rate(mtbf: Array, source: str) -> Factor:
    """λ = 1 / MTBF"""
    return Factor("1/MTBF", 1 / np.abs(mtbf), source)
