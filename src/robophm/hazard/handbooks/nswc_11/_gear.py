"""Common parts of gears and splines, NSWC-11 chapter 8."""

from __future__ import annotations

from collections.abc import Mapping

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.nswc_11 import TITLE, TWICE, heat, size, viscosity
from robophm.hazard.model import Array, Choice, Factor, Input, Range

SOURCE = Source(TITLE, "8", "Eqs 8-2 … 8-9, Table 8-1", f"formulas single, Table 8-1 {TWICE}")

SERVICE = Table("AGMA service factor C_GV", SOURCE, """
    uniform       1.0   1.25  1.75
    medium_shock  1.25  1.5   2.0
    heavy_shock   1.5   1.75  2.25
""", columns=("uniform", "medium_shock", "heavy_shock"))  # fmt: skip

MOVING: Mapping[str, Input] = {
    "speed": Range(1e-3, 1e6, "rpm", "V_O, as operated", monotone=1),
    "design_speed": Range(1e-3, 1e6, "rpm", "V_D, as designed for", monotone=-1),
}
MISALIGNMENT = Range(1e-3, 10.0, "deg", "A_E, angle between the axes; 0.34 degrees is the reference", monotone=1)
SERVED: Mapping[str, Input] = {
    "specified_viscosity": Range(0.1, 1e6, "mm^2/s", "ν_O, of the lubricant that is specified", monotone=1),
    "lubricant_viscosity": Range(0.1, 1e6, "mm^2/s", "ν_L, of the lubricant that is used", monotone=-1),
    "temperature": Range(-60.0, 300.0, "degC", "of operation", monotone=1, warmth="own"),
    "prime_mover": Choice(SERVICE, "what drives"),
    "driven_load": Choice(SERVICE.columns, "what is driven"),
}


def speed_factor(speed: Array, design_speed: Array) -> Factor:
    """The speed factor C_GS."""
    return Factor("C_GS", 1 + (size(speed) / size(design_speed)) ** 0.7, "1 + (V_O/V_D)^0.7")


def served(
    specified_viscosity: Array, lubricant_viscosity: Array, temperature: Array, prime_mover: str, driven_load: str
) -> tuple[Factor, ...]:
    """The factors of use: C_GL · C_GT · C_GV."""
    return (
        viscosity("C_GL", specified_viscosity, lubricant_viscosity),
        heat("C_GT", temperature),
        Factor("C_GV", SERVICE.cell(prime_mover, driven_load), f"{prime_mover} driving, {driven_load} driven"),
    )
