"""Common parts of hydraulic and pneumatic actuators under side or axial load, NSWC-11 chapter 9."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.nswc_11 import (
    INCH,
    PER_CYCLE,
    PSI,
    TITLE,
    TWICE,
    looked_up,
    of_table,
    or_other,
    product,
    size,
)
from robophm.hazard.model import Array, Choice, Factor, Input, Range

SOURCE_TEXT = f"γ and k1 {TWICE}; yield strengths single"
SIDE = Source(TITLE, "9", "side load", f"{SOURCE_TEXT}; geometry from contact mechanics, which gives k1 within 2 %")
AXIAL = Source(
    TITLE,
    "9",
    "axial load",
    f"{SOURCE_TEXT}; k2 = 17.7·10³ unverified: contact mechanics gives about 4.3·10³, a rate 4 times as high",
)

WEAR = Table("shear over yield γ", SIDE, """
    adhesive_prone   0.20  pairs that tend to adhesive wear
    little_transfer  0.54  pairs with little tendency to transfer
""")  # fmt: skip

YIELD = Table("yield strength", SIDE, """
    structural_steel          30   40
    low_alloy_high_strength   40   80
    heat_treated_cast_steel   40  120
    cold_rolled               70   85
    stainless                 50   80
    heat_treated_wrought_al   10   50
    al_alloy                  35   42
    pure_rolled_al             5   21
    cast_al                   15   25
    wrought_iron              25   35
    cast_iron                  8   40
    magnesium_alloy           11   30
""", columns=("from, kpsi", "to, kpsi"))  # fmt: skip

PARTICLES = Table("number of particles C_N", SIDE, """
    most    1.0  most applications
    severe  2.0
""")  # fmt: skip

GEOMETRY: Mapping[str, Input] = {
    "bore": Range(1.0, 3000.0, "mm", "D1, of the cylinder, above the piston's", monotone=1),
    "piston_diameter": Range(1.0, 3000.0, "mm", "D2", monotone=-1),
    "cylinder_modulus": Range(10.0, 500.0, "GPa", "E1, of elasticity", monotone=1),
    "cylinder_poisson": Range(0.0, 0.5, "", "μ1, Poisson's ratio", monotone=1),
    "piston_modulus": Range(10.0, 500.0, "GPa", "E2, of elasticity", monotone=1),
    "piston_poisson": Range(0.0, 0.5, "", "μ2, Poisson's ratio", monotone=1),
}
AROUND: Mapping[str, Input] = {
    "wear": Choice(WEAR, "of the pair of materials"),
    "material": or_other(YIELD, "of the softer part; its range's lower end counts", "yield_strength"),
    "yield_strength": Range(
        10.0,
        3000.0,
        "MPa",
        "F_Y, instead of the table's",
        required=False,
        monotone=-1,
        otherwise=of_table(YIELD, "material", "from, kpsi", PSI * 1e3),
    ),
    "particle_hardness": Range(1.0, 3000.0, "", "H_P, on one scale with the cylinder's", monotone=1),
    "cylinder_hardness": Range(1.0, 3000.0, "", "H_C, on one scale with the particles'", monotone=-1),
    "filter_size": Range(0.1, 1000.0, "um", "of the fluid's filter", monotone=1),
    "particles": Choice(PARTICLES, "how many", default="most"),
    "temperature": Range(-60.0, 250.0, "degC", "of operation", monotone=1, warmth="own"),
}


def gap(bore: Array, piston_diameter: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
    """(D1 − D2)/(D1·D2) [1/inch], none below zero, and where the piston is not smaller than the bore."""
    wider, narrower = size(bore) / INCH, size(piston_diameter) / INCH
    return np.maximum(1 / narrower - 1 / wider, 0.0), wider <= narrower


def compliance(cylinder_modulus: Array, cylinder_poisson: Array, piston_modulus: Array, piston_poisson: Array) -> Array:
    """K = (1 − μ1²)/E1 + (1 − μ2²)/E2 [1/psi]: of Hertz, a sum."""
    first = (1 - np.square(cylinder_poisson)) / (size(cylinder_modulus) * 1e3 / PSI)
    second = (1 - np.square(piston_poisson)) / (size(piston_modulus) * 1e3 / PSI)
    result: Array = first + second
    return result


def wearing(
    constant: float,
    stress: Array,
    outside: npt.NDArray[np.bool_],
    wear: str,
    material: str,
    yield_strength: Array | None,
    particle_hardness: Array,
    cylinder_hardness: Array,
    filter_size: Array,
    particles: str,
    temperature: Array,
) -> Factor:
    """10⁶/N_O · C_H · C_S · C_N · C_T, with N_O = constant · (γ·F_Y/stress [psi])⁹."""
    strength, note = looked_up(YIELD, material, "from, kpsi", yield_strength, "yield_strength", PSI * 1e3)
    shear = WEAR[wear] * strength * 1e3
    kelvin = np.maximum(np.asarray(temperature) + 273, 1.0)
    return product(
        (
            Factor(
                "10⁶/N_O",
                1e6 / constant * (stress / shear) ** 9,
                f"{wear}, yield strength {note}, bore wider than the piston; failures/10⁶ cycles",
                outside=outside,
                beyond=lambda: "the piston's diameter is not smaller than the cylinder's bore",
            ),
            Factor("C_H", size(particle_hardness) / size(cylinder_hardness), "H_P/H_C"),
            Factor("C_S", size(filter_size) / 10, "filter size/10 µm"),
            Factor("C_N", PARTICLES[particles], f"{particles} particles"),
            Factor("C_T", np.exp(1200 / 298.2 * (1 - 298.2 / kelvin)), "1 at 25.2 °C, kelvin as T + 273"),
            PER_CYCLE,
        )
    )
