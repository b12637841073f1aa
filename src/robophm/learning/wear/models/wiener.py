"""Wear that goes straight, on average: the Wiener process with noise, dX = μ dt + σ dW."""

from __future__ import annotations

from robophm.learning.wear.models.candidates import DegradationPath
from robophm.learning.wear.models.scaled_wiener import Scale, ScaledWiener, as_it_is


def scales(course: DegradationPath) -> list[Scale]:
    """Return the one scale on which wear and time are as they are."""
    return [Scale(1.0, as_it_is)]


def candidates(course: DegradationPath) -> ScaledWiener:
    """Return the candidates of this model; it fits any path of wear."""
    return ScaledWiener(course, scales(course))
