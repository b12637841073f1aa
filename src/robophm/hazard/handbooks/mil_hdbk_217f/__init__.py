"""MIL-HDBK-217F Notice 2, parts-stress method. What its sections share."""

from __future__ import annotations

import numpy as np

from robophm.core.table import Table, band
from robophm.hazard.model import PER_MILLION_HOURS, Array, Factor

TITLE = "MIL-HDBK-217F Notice 2"


def handbook_arrhenius(temperature: Array, activation_energy: float, reference: float = 298.0) -> Array:
    """The handbook's own Arrhenius factor, 1 at the reference [K]: T + 273, 25 °C = 298 K, k = 8.617e-5 eV/K.

    What a broken sensor says below 1 K counts as 1 K: beyond the pole at 0 K the formula would be infinite.
    """
    result: Array = np.empty(np.shape(temperature))  # one array all the way
    np.add(temperature, 273.0, out=result)
    np.maximum(result, 1.0, out=result)
    np.divide(1, result, out=result)
    result -= 1 / reference
    result *= -activation_energy / 8.617e-5
    np.exp(result, out=result)
    return result


def steps(table: Table, value: Array, column: str = "") -> Array:
    """The row of a table whose keys are upper limits; above the last limit, which a flag tells, the last row holds."""
    limits = tuple(float(limit) for limit in table)
    results = tuple(table.cell(limit, column or table.columns[0]) for limit in table)
    return band(value, (*limits[:-1], np.inf), results)


def per_million_hours() -> Factor:
    """The handbook's unit as the last factor of a formula."""
    return Factor("10⁻⁶", PER_MILLION_HOURS, "failures/10⁶ h to 1/h")


def span(values: Array | float) -> str:
    """A number, or from where to where many go, for the note of a factor."""
    if not np.ndim(values):
        return f"{float(values):.3g}"
    low, high = np.min(values), np.max(values)
    return f"{low:.3g}" if low == high else f"{low:.3g} … {high:.3g}"
