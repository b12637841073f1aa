"""Wear along a power of time, X = X₀ + μ·tᵇ: Whitmore and Schenkelberg (Lifetime Data Anal. 3, 1997).

Diffusion and oxide growth go as √t, steady wear as t, creep in its third stage and settled fatigue as t² or t³. The
prior of ln b is normal about 0 with a deviation of 0.7: nine in ten between t^0.3 and t^3.2.
"""

from __future__ import annotations

import numpy as np

from robophm.learning.wear.models.candidates import DegradationPath, prior_over
from robophm.learning.wear.models.scaled_wiener import Scale, ScaledWiener, as_it_is

LOG_POWERS = np.linspace(-1.0, 1.6, 14)


def scales(course: DegradationPath) -> list[Scale]:
    """Return the scales, one for each power of the part's own clock."""
    weights = prior_over(LOG_POWERS, 0.0, 0.7)
    return [Scale(w, as_it_is, float(np.exp(b)), int(np.sign(b))) for w, b in zip(weights, LOG_POWERS, strict=True)]


def candidates(course: DegradationPath) -> ScaledWiener:
    """Return the candidates of this model; it fits any path of wear."""
    return ScaledWiener(course, scales(course))
