"""MIL-HDBK-217F Notice 2, parts-stress method. What its sections share."""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source
from robophm.hazard.model import Array

TITLE = "MIL-HDBK-217F Notice 2"

ENVIRONMENTS = {
    "GB": "Ground, Benign",
    "GF": "Ground, Fixed",
    "GM": "Ground, Mobile",
    "NS": "Naval, Sheltered",
    "NU": "Naval, Unsheltered",
    "AIC": "Airborne, Inhabited Cargo",
    "AIF": "Airborne, Inhabited Fighter",
    "AUC": "Airborne, Uninhabited Cargo",
    "AUF": "Airborne, Uninhabited Fighter",
    "ARW": "Airborne, Rotary Wing",
    "SF": "Space, Flight",
    "MF": "Missile, Flight",
    "ML": "Missile, Launch",
    "CL": "Cannon, Launch",
}
"""Symbols of Table 3-2. A mobile robot is GM by the handbook's definition."""

ENVIRONMENT_SOURCE = Source(TITLE, "3", "3-3 (Table 3-2)", "two sources agree")


def handbook_arrhenius(temperature: Array, activation_energy: float) -> Array:
    """The handbook's own Arrhenius factor, 1 at 25 °C: T + 273, 298 K, k = 8.617e-5 eV/K as printed.

    What a broken sensor says below 1 K counts as 1 K: beyond the pole at 0 K the formula would be infinite.
    """
    kelvin = np.maximum(np.asarray(temperature) + 273, 1.0)
    result: Array = np.exp(-activation_energy / 8.617e-5 * (1 / kelvin - 1 / 298))
    return result
