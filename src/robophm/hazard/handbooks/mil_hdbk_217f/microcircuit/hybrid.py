"""MIL-HDBK-217F(2) §5.5, hybrids:  λp = Σ Nc λc · (1 + 0.2 πE) · πF · πQ · πL   failures/10⁶ h

Σ Nc λc is the sum of the rates of what is inside, each by its own section with πE = πQ = 1. All πF but that of
linear circuits are from one transcription.
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit import (
    ENVIRONMENT,
    ENVIRONMENTS,
    QUALITIES,
    SCREENING,
    YEARS,
    learning_factor,
    quality_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "5.5",
    "–",
    "linear checked against a worked example; the other πF from a single transcription; "
    "limit of 200 screening points from memory",
)

FUNCTION = Table("hybrid πF", SOURCE, """
    digital    1.0
    video      1.2  10 MHz to 1 GHz
    microwave  2.6  above 1 GHz
    linear     5.8  below 10 MHz
    power      21
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "component_rate": Range(1e-12, 1e-3, "1/h", "sum of the rates of its components, at πE = πQ = 1", monotone=1),
        "function": Choice(FUNCTION, "what the circuit is for"),
        "years_in_production": YEARS,
        "quality": QUALITIES,
        "screening_points": SCREENING,
        "environment": ENVIRONMENTS,
    },
)
def hazard_rate(
    component_rate: Array,
    function: str,
    years_in_production: Array,
    quality: str,
    environment: str,
    screening_points: Array | None = None,
) -> Factor:
    """λp = Σ Nc λc · (1 + 0.2 πE) · πF · πQ · πL"""
    return (
        Factor("Σ Nc λc", np.asarray(component_rate), "components at πE = πQ = 1, 1/h")
        * Factor("1 + 0.2 πE", 1 + 0.2 * ENVIRONMENT[environment], f"environment {environment}")
        * Factor("πF", FUNCTION[function], f"{function} {FUNCTION.notes[function]}".rstrip())
        * quality_factor(quality, screening_points)
        * learning_factor(years_in_production)
    )
