"""Increments of readings of a Wiener process with noise: their covariance at ratios of noise to wandering.

Y = X + ε of dX = μ dt + σ dW: from one reading to the next, increments vary by dt + 2τ and follow on by −τ [σ²], where
τ is the variance of the noise.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.linalg import cholesky_banded, solve_banded

Array = npt.NDArray[np.float64]

RATIOS = np.geomspace(1e-4, 1e4, 41)
"""Ratios of the variance of the noise to that of wandering between two readings, over which is integrated."""

PRIOR = 1 / np.sqrt(1 + RATIOS)
"""Prior weight of each ratio, by decades: all alike where noise is small, and falling where it is not, as a half-Cauchy
deviation of wandering over noise does (Gelman, Bayesian Analysis 1, 2006). Were it flat there too, most of it would lie
where wear does not wander at all, and intervals would be too narrow."""


def root_of_covariance(dt: Array, tau: float) -> Array:
    """The upper band of a Cholesky factor of the increments' covariance [σ²]; shape (2, increments).

    ``tau``: variance of a reading's noise [σ²].
    """
    band = np.zeros((2, len(dt)))
    band[1] = dt + 2 * tau
    band[0, 1:] = -tau
    result: Array = cholesky_banded(band)
    return result


def whitened(root: Array, values: Array) -> Array:
    """U⁻ᵀ·values, U the upper band of a Cholesky factor; shape of ``values``, one column or several."""
    lower = np.zeros((2, len(values)))
    lower[0] = root[1]
    lower[1, :-1] = root[0, 1:]
    result: Array = solve_banded((1, 0), lower, values)
    return result
