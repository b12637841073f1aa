"""Conversion of the age at which a tenth have failed to the rate of which 1/λ is the mean life."""

from __future__ import annotations

from math import log

import numpy as np

from robophm.core.table import Source
from robophm.hazard.model import Array, Factor, Note, Range

SOURCE = Source("a maker's figure", "–", "–", "as stated in the design; closed form of the Weibull distribution")
SHAPE = Range(0.2, 20.0, "", "Weibull shape of the life; state the same under 'life'", default=1.0)
NOTE = Note("who states it, and for which load")


def rate_of_b10(b10: Array, shape: Array, source: str) -> Factor:
    """1/mean of the Weibull distribution of that shape of which a tenth have failed at B10."""
    life = (-log(0.9)) ** (1 / np.asarray(shape)) / np.abs(b10)
    from scipy.special import gamma  # takes a fifth of a second to load

    share = 1 / gamma(1 + 1 / np.asarray(shape))
    return Factor("1/η", life, f"scale at which 10 % have failed: {source}") * Factor("1/Γ(1 + 1/β)", share, "Weibull")
