"""Wear whose rate is a power of the signal itself, dX/dt = C·Xᵖ: Paris's law of cracks, Box and Cox's scale.

The stress intensity of a crack of length X goes as √X, so that Paris's exponent m of 2 to 4 makes p = m/2 of 1 to 2;
p = 0 goes straight, and diffusion through its own product has p = −1. The prior of p is normal about 0.5 with a
deviation of 1.5. It needs a signal whose zero is one of wear, and that never changes sign.
"""

from __future__ import annotations

import numpy as np

from robophm.learning.wear.models.candidates import DegradationPath, prior_over
from robophm.learning.wear.models.scaled_wiener import Scale, ScaledWiener, growing

EXPONENTS = np.array([-2.0, -1.0, -0.5, 0.5, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 6.0])


def scales(course: DegradationPath) -> list[Scale]:
    """Exponents of growth; none where the signal has no zero of its own."""
    if course.gain is None:
        return []
    weights = prior_over(EXPONENTS, 0.5, 1.5)
    return [
        Scale(w, growing(course.gain, p), accelerates=int(np.sign(p * course.gain)))
        for w, p in zip(weights.tolist(), EXPONENTS.tolist(), strict=True)
    ]


def candidates(course: DegradationPath) -> ScaledWiener | None:
    """None of a signal that has no zero of its own, or changes sign."""
    return ScaledWiener(course, found) if (found := scales(course)) else None
