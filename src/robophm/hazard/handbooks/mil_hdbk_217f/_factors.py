"""Factors that the sections of MIL-HDBK-217F Notice 2 have in common."""

from __future__ import annotations

import numpy as np

from robophm.core.table import Table
from robophm.hazard.model import PER_MILLION_HOURS, Array, Factor

STEEPEST = 10.0
"""Where a stress ratio in an exponential ends: a broken sensor must not make a rate infinite."""


def stress_ratio(applied: Array, rated: Array) -> Array:
    """The share of its rating that a part bears. A measured reversal counts by its magnitude."""
    result: Array = np.abs(applied) / np.asarray(rated)
    return result


def closing(quality_table: Table, quality: str, environment_table: Table, environment: str) -> Factor:
    """πQ · πE, and what turns failures/10⁶ h into 1/h."""
    return Factor("πQ", quality_table[quality], f"quality {quality}") * surroundings(environment_table, environment)


def surroundings(environment_table: Table, environment: str) -> Factor:
    """πE, and what turns failures/10⁶ h into 1/h."""
    return Factor("πE", environment_table[environment], f"environment {environment}") * Factor(
        "10⁻⁶", PER_MILLION_HOURS, "failures/10⁶ h to 1/h"
    )


def span(values: Array | float) -> str:
    """A number, or from where to where many go."""
    low, high = np.min(values), np.max(values)
    return f"{low:.3g}" if low == high else f"{low:.3g} … {high:.3g}"
