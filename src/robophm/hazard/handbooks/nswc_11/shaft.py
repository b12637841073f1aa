"""NSWC-11 §20 Eq 20-3, shafts:  λ = 10⁶/N · C_f · C_T · C_DY · C_SC   failures/10⁶ cycles

N, the cycles to failure at the stress applied, is of the material's S-N curve and the user's to state. C_DY is of one
length, or of two where the shaft steps up from ``diameter`` to ``step_diameter``. C_SC = C_SC,R (0 without a step) +
C_SC,G (1.0 without a groove). The handbook's C_f is below 1 for a rough finish, which lowers the rate: kept as printed.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table
from robophm.hazard.handbooks.nswc_11 import (
    INCH,
    PER_CYCLE,
    POUND,
    PSI,
    TITLE,
    TWICE,
    heat,
    looked_up,
    of_table,
    or_other,
    product,
    size,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE, "20", "Eq 20-3, Tables 20-1 … 20-4", f"{TWICE}; tables of E and of bending single; limits are of sanity"
)

FINISH = Table("shaft finish C_f", SOURCE, """
    polished              1.00   0        0        0
    ground                0.89   0        0        0
    hot_rolled            0.94  -0.0046   8.37e-6  0
    machined_cold_drawn   1.07  -0.0051   2.21e-5 -3.57e-8
    forged                0.75  -4.06e-3  7.58e-6  0
""", columns=("1", "TS", "TS²", "TS³"))  # fmt: skip

ELASTICITY = Table("shaft material", SOURCE, """
    alloy_steel           30
    stainless             29
    high_carbon_steel     30
    cast_steel_carbon     30
    low_alloy_cast_steel  30
    cast_aluminum         10.3
    wrought_aluminum      10.45
""", columns=("E, 10⁶ psi",))  # fmt: skip

BENDING = Table("shaft equipment", SOURCE, """
    actuator    0.007
    compressor  0.025
    motor       0.01
    pump        0.007
""", columns=("b, in",))  # fmt: skip

GROOVE = Table("shaft groove C_SC,G", SOURCE, """
    0.05  1.1  1.45  1.6  2.0   2.05  nan   nan
    0.1   1.0  1.27  1.4  1.7   2.0   2.25  nan
    0.2   1.0  1.1   1.2  1.31  1.6   1.75  2.0
    0.3   1.0  1.1   1.1  1.2   1.35  1.48  1.55
""", columns=("0.1", "0.5", "1.0", "2.0", "4.0", "6.0", "8.0"))  # fmt: skip
"""Rows h/D, columns h/r; nan where the handbook's cell is blank."""


@hazard_model(
    source=SOURCE,
    unit="1/cycle",
    inputs={
        "cycles_to_failure": Range(1.0, 1e15, "cycle", "N, of the S-N curve at the stress applied", monotone=-1),
        "finish": Choice(FINISH, "of the surface"),
        "tensile_strength": Range(200.0, 1700.0, "MPa", "TS, of the finish's factor"),
        "temperature": Range(-60.0, 400.0, "degC", "of operation", monotone=1, warmth="own"),
        "force": Range(1e-3, 1e8, "N", "F, on the shaft", monotone=1, stress="load"),
        "material": or_other(ELASTICITY, "by which it is elastic", "elastic_modulus"),
        "elastic_modulus": Range(
            10.0,
            500.0,
            "GPa",
            "E, instead of the table's",
            required=False,
            monotone=-1,
            otherwise=of_table(ELASTICITY, "material", "E, 10⁶ psi", PSI * 1e3),
        ),
        "equipment": or_other(BENDING, "by which it may bend", "allowable_bending"),
        "allowable_bending": Range(
            1e-3,
            100.0,
            "mm",
            "b, instead of the table's",
            required=False,
            monotone=-1,
            otherwise=of_table(BENDING, "equipment", "b, in", INCH),
        ),
        "diameter": Range(0.5, 2000.0, "mm", "d, of the (thinner) shaft"),
        "length": Range(1.0, 1e5, "mm", "of the (thinner) shaft", monotone=1),
        "step_diameter": Range(0.5, 2000.0, "mm", "D, of the thicker part where it steps up", required=False),
        "step_length": Range(1.0, 1e5, "mm", "of the thicker part", required=False, monotone=1),
        "fillet_radius": Range(0.01, 1000.0, "mm", "r, of the step's fillet", required=False),
        "groove_depth": Range(0.01, 1000.0, "mm", "h, of a groove", required=False),
        "groove_radius": Range(0.001, 1000.0, "mm", "r, of the groove's bottom", required=False),
    },
)
def hazard_rate(
    cycles_to_failure: Array,
    finish: str,
    tensile_strength: Array,
    temperature: Array,
    force: Array,
    material: str,
    equipment: str,
    diameter: Array,
    length: Array,
    elastic_modulus: Array | None = None,
    allowable_bending: Array | None = None,
    step_diameter: Array | None = None,
    step_length: Array | None = None,
    fillet_radius: Array | None = None,
    groove_depth: Array | None = None,
    groove_radius: Array | None = None,
) -> Factor:
    """λ = 10⁶/N · C_f · C_T · C_DY · C_SC"""
    strength = size(tensile_strength) / PSI / 1e3
    surface = sum(FINISH.cell(finish, column) * strength**power for power, column in enumerate(FINISH.columns))
    E, of = looked_up(ELASTICITY, material, "E, 10⁶ psi", elastic_modulus, "elastic_modulus", PSI * 1e3)
    b, by = looked_up(BENDING, equipment, "b, in", allowable_bending, "allowable_bending", INCH)
    bends = _bending(length, diameter)
    step = Factor("C_SC,R", 0.0, "no step")
    if step_diameter is not None:
        if step_length is None or fillet_radius is None:
            raise ModelError("nswc_11.shaft: a step needs 'step_length' and 'fillet_radius'")
        bends = bends + _bending(step_length, step_diameter)
        step = _step(size(step_diameter), size(diameter), size(fillet_radius))
    groove = Factor("C_SC,G", 1.0, "no groove")
    if groove_depth is not None:
        if groove_radius is None:
            raise ModelError("nswc_11.shaft: a groove needs 'groove_radius'")
        factor, outside = groove_factor(size(groove_depth) / size(diameter), size(groove_depth) / size(groove_radius))
        groove = Factor(
            "C_SC,G",
            factor,
            "Table 20-4, of h/D and h/r, between its rows and columns",
            outside=outside,
            beyond=lambda: (
                f"the table has no groove {_span(groove_depth)} mm deep with a radius of {_span(groove_radius)} mm "
                f"in a shaft of {_span(diameter)} mm"
            ),
        )
    bending = 0.0043 * size(force) / POUND / (E * 1e6 * b) * bends
    return product(
        (
            Factor("10⁶/N", 1e6 / size(cycles_to_failure), "failures/10⁶ cycles"),
            Factor("C_f", np.maximum(surface, 0.0), f"{finish}; as printed, a rough finish lowers the rate"),
            heat("C_T", temperature),
            Factor("C_DY", bending, f"0.0043 F/(E·b) · Σ L³/I, E of {of}, b of {by}"),
            step + groove,
            PER_CYCLE,
        )
    )


def _span(values: Array | None) -> str:
    return f"{float(np.max(values)):.6g}" if values is not None else "no"


def _bending(length: Array, diameter: Array) -> Array:
    """L³/I [1/inch], I = π·d⁴/64."""
    result: Array = (size(length) / INCH) ** 3 / (np.pi * (size(diameter) / INCH) ** 4 / 64)
    return result


def _step(wide: Array, narrow: Array, radius: Array) -> Factor:
    """C_SC,R = (0.3/(r/d))^0.2 · (D/d)^(1 − r/d)."""
    curve = radius / narrow
    value = (0.3 / curve) ** 0.2 * (wide / narrow) ** (1 - curve)
    return Factor(
        "C_SC,R",
        value,
        "of a step up, D above d, fillet below d",
        outside=(wide <= narrow) | (curve >= 1),
        beyond=lambda: (
            f"a step from {_span(narrow)} mm up to {_span(wide)} mm with a fillet of {_span(radius)} mm is none"
        ),
    )


def groove_factor(depth: Array, sharpness: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
    """C_SC,G at h/D and h/r, linear between cells; and where the table has no answer, which is the nearest cell's."""
    rows = np.array([float(row) for row in GROOVE])
    columns = np.array([float(column) for column in GROOVE.columns])
    cells = np.array(list(GROOVE.rows.values()))
    filled = np.where(np.isnan(cells), np.nanmax(cells, axis=1, keepdims=True), cells)
    depth, sharpness = np.broadcast_arrays(np.asarray(depth, dtype=float), np.asarray(sharpness, dtype=float))
    outside = (depth < rows[0]) | (depth > rows[-1]) | (sharpness < columns[0]) | (sharpness > columns[-1])
    i, u = _between(depth, rows)
    j, v = _between(sharpness, columns)
    value = np.zeros(depth.shape)
    for row, weight_row in ((i, 1 - u), (i + 1, u)):
        for column, weight in ((j, weight_row * (1 - v)), (j + 1, weight_row * v)):
            value = value + weight * filled[row, column]
            outside = outside | ((weight > 0) & np.isnan(cells[row, column]))
    return value, outside


def _between(value: Array, grid: Array) -> tuple[npt.NDArray[np.int_], Array]:
    """The cell of a grid that holds a value, the nearest where none does, and how far into it."""
    inside = np.clip(value, grid[0], grid[-1])
    cell = np.clip(np.searchsorted(grid, inside, side="right") - 1, 0, len(grid) - 2)
    return cell, (inside - grid[cell]) / (grid[cell + 1] - grid[cell])
