"""Tests that demonstrate a reliability: ``robophm.demonstrate``."""

from __future__ import annotations

from robophm.learning.life_data.demonstration import TestPlan, Wanted, demonstration


def demonstrate(
    reliability: float, at: float, *, confidence: float = 0.9, allowed: int = 0, shape: float = 1.0,
    units: int | None = None, hours: float | None = None,
) -> TestPlan:  # fmt: skip
    """How many to test, for how long, so that at most ``allowed`` failures demonstrate a reliability at a time [h].

    For a Weibull life of this ``shape``; 1 is a constant rate. Of so many ``hours`` each, by default until ``at``, the
    fewest units; of so many ``units`` the shortest time [h]; of both, the confidence that the test has. Raises
    RobophmError for what cannot be.
    """
    return demonstration(Wanted(reliability, at, confidence, allowed, shape), units, hours)
