"""Wear along an exponential path with random effects, ln(X − φ) = θ + βt + wandering.

Gebraeel and others (IIE Trans. 37, 2005). θ and β are known as a normal distribution that every reading updates by
Bayes. What φ leaves to be told is how many times as fast the wear goes at the threshold as it did at the first reading:
below 1 it saturates, as the light of a diode does. Its logarithm is normal a priori about 0 with a deviation of 2: nine
in ten between 1/27 and 27 times.
"""

from __future__ import annotations

import numpy as np

from robophm.learning.wear.models.candidates import DegradationPath, prior_over
from robophm.learning.wear.models.scaled_wiener import Scale, ScaledWiener, growing

TIMES_AS_FAST = np.array([0.1, 0.2, 0.4, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 512.0])


def scales(course: DegradationPath) -> list[Scale]:
    """Return the scales by how many times as fast wear goes at the threshold as at the first reading."""
    weights = prior_over(np.log(TIMES_AS_FAST), 0.0, 2.0)
    return [
        Scale(w, growing(fast - 1, 1.0), accelerates=int(np.sign(fast - 1)))
        for w, fast in zip(weights.tolist(), TIMES_AS_FAST.tolist(), strict=True)
    ]


def candidates(course: DegradationPath) -> ScaledWiener:
    """Return the candidates of this model; it fits any path of wear."""
    return ScaledWiener(course, scales(course))
