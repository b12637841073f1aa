"""Contacts that switch a load: the load factor that relays (§13.1) and switches (§14.1) share."""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.model import Array, Factor, more_than

SOURCE = Source(
    TITLE,
    "13.1, 14.1",
    "–",
    "two transcriptions agree; printed up to S = 1 resistive, 0.7 inductive, 0.4 lamp",
)

LOAD = Table("contact load, divisor d", SOURCE, """
    resistive  0.8
    inductive  0.4
    lamp       0.2
""")  # fmt: skip


def load_factor(load: str, load_current: Array, rated_current: Array) -> Factor:
    """πL = exp((S/d)²), S = load current / rated resistive current; above S = 1 it is flagged and stays as at 1.

    The handbook has no answer there, and the formula would make of one measured inrush the end of the robot.
    """
    stress = np.abs(load_current) / np.asarray(rated_current)
    return Factor(
        "πL",
        np.exp((np.minimum(stress, 1.0) / LOAD[load]) ** 2),
        f"{load} load, stress S = {span(stress)} of at most 1",
        outside=above(stress, 1.0),
        beyond=more_than("the load current", np.abs(load_current), "the rated current", rated_current, "A"),
    )
