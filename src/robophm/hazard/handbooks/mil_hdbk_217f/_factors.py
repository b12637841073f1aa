"""Factors that the sections of MIL-HDBK-217F Notice 2 have in common."""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE
from robophm.hazard.model import PER_MILLION_HOURS, Array, Factor

WEAR = Source(TITLE, "12.1", "12-3", "three transcriptions agree")
EFFECTIVE_FAILURES = Table("effective cumulative failures λ1, λ2 up to LC/α", WEAR, """
    0.10  0.13
    0.20  0.15
    0.30  0.23
    0.40  0.31
    0.50  0.41
    0.60  0.51
    0.70  0.61
    0.80  0.68
    0.90  0.76
    inf   1.0   printed for above 1.0; 0.91 to 1.0 is not printed
""")  # fmt: skip
"""Failures of what wears out, by its design life over its characteristic life α: motors (§12.1), joints (§16.2)."""

STEEPEST = 10.0
"""Largest stress ratio in an exponential: a broken sensor must not make a rate infinite."""


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
