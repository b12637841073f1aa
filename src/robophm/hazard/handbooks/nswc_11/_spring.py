"""Common parts of all springs, NSWC-11 chapter 4: materials, strength, cycle rate."""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.handbooks.nswc_11 import INCH, ONCE, PSI, TITLE, TWICE, looked_up, of_table, or_other, size
from robophm.hazard.model import Array, Factor, Input, Range

HELICAL = Source(
    TITLE, "4", "Eq 4-6, Tables 4-2, 4-3", f"{TWICE}; Wahl's factor single, and as in mechanics; limits are of sanity"
)
OTHERS = Source(TITLE, "4", "Eqs 4-5 … 4-22, Tables 4-2 … 4-4", f"{ONCE}; limits are of sanity")

MATERIAL = Table("spring material", HELICAL, """
    music_wire             11.8  1.08  29.0  1.05
    hard_drawn_steel       11.5  1.00  28.5  1.00
    chrome_steel           11.2  0.92  29.0  1.05
    silicon_manganese      10.8  0.83  29.0  1.05
    stainless_302_304_316  10.0  0.67  28.0  0.98  printed factors do not follow from the moduli, which count
    stainless_17_7_PH      10.5  0.76  29.5  1.04  printed C_E does not follow from the modulus, which counts
    stainless_420          11.0  0.88  29.0  1.05
    stainless_431          11.4  0.97  29.5  1.11
    spring_brass            5.0  0.08  15.0  0.15
    phosphor_bronze         6.0  0.14  15.0  0.15
    beryllium_copper        7.0  0.23  17.0  0.21
    inconel                10.5  0.76  31.0  1.09  printed C_E does not follow from the modulus, which counts
    monel                   9.5  0.56  26.0  0.76
""", columns=("G_M, 10⁶ psi", "C_G printed", "E_M, 10⁶ psi", "C_E printed"))  # fmt: skip

STRENGTH = Table("spring alloy", HELICAL, """
    brass                110  5.15
    phosphor_bronze      125  3.51
    monel_400            145  2.25
    inconel_600          158  1.74
    monel_K500           175  1.28
    copper_beryllium     190  1.00
    17_7_PH_RH950        210  0.74
    hard_drawn_steel     216  0.68
    stainless_302_18_8   227  0.59
    spring_temper_steel  245  0.47
    chrome_silicon       268  0.36
    music_wire           295  0.27
""", columns=("T_S, kpsi", "C_Y printed"))  # fmt: skip


def length(low: float, high: float, description: str, monotone: int) -> Range:
    """An input that is a length in mm."""
    return Range(low, high, "mm", description, monotone=monotone)


SHEAR: dict[str, Input] = {
    "material": or_other(MATERIAL, "of Table 4-2, by which it is rigid", "shear_modulus"),
    "shear_modulus": Range(
        5.0,
        200.0,
        "GPa",
        "modulus of rigidity, instead of the table's",
        required=False,
        monotone=1,
        otherwise=of_table(MATERIAL, "material", "G_M, 10⁶ psi", PSI * 1e3),
    ),
}
ELASTIC: dict[str, Input] = {
    "material": or_other(MATERIAL, "of Table 4-2, by which it is elastic", "elastic_modulus"),
    "elastic_modulus": Range(
        10.0,
        500.0,
        "GPa",
        "modulus of elasticity, instead of the table's",
        required=False,
        monotone=1,
        otherwise=of_table(MATERIAL, "material", "E_M, 10⁶ psi", PSI * 1e3),
    ),
}
COMMON: dict[str, Input] = {
    "alloy": or_other(STRENGTH, "of Table 4-3, by which it is strong", "tensile_strength"),
    "tensile_strength": Range(
        100.0,
        5000.0,
        "MPa",
        "ultimate tensile strength, instead of the table's",
        required=False,
        monotone=-1,
        otherwise=of_table(STRENGTH, "alloy", "T_S, kpsi", PSI * 1e3),
    ),
    "cycle_rate": Range(0.0, 1e4, "cycle/min", "how often it is loaded", monotone=1),
    "corrosion": Range(1.0, 10.0, "", "C_R: 1 where protected, else by experience", default=1.0, monotone=1),
    "manufacture": Range(1.0, 10.0, "", "C_M: 1 under quality control, else by experience", default=1.0, monotone=1),
}


def ratio(symbol: str, value: Array, reference: float, power: int, note: str) -> Factor:
    """(value [mm] / reference [inch])^power."""
    return Factor(symbol, (size(value) / INCH / reference) ** power, note)


def rigidity(material: str, shear_modulus: Array | None) -> Factor:
    """C_G = (G_M/11.5·10⁶ psi)³."""
    modulus, note = looked_up(MATERIAL, material, "G_M, 10⁶ psi", shear_modulus, "shear_modulus", PSI * 1e3)
    return Factor("C_G", (modulus / 11.5) ** 3, note)


def elasticity(material: str, elastic_modulus: Array | None) -> Factor:
    """C_E = (E_M/28.5·10⁶ psi)³."""
    modulus, note = looked_up(MATERIAL, material, "E_M, 10⁶ psi", elastic_modulus, "elastic_modulus", PSI * 1e3)
    return Factor("C_E", (modulus / 28.5) ** 3, note)


def common(
    alloy: str, tensile_strength: Array | None, cycle_rate: Array, corrosion: Array, manufacture: Array
) -> tuple[Factor, ...]:
    """C_Y · C_CS · C_R · C_M."""
    strength, note = looked_up(STRENGTH, alloy, "T_S, kpsi", tensile_strength, "tensile_strength", PSI * 1e3)
    rate = size(cycle_rate)
    speed = np.where(above(rate, 300.0), (rate / 300) ** 3, np.maximum(rate, 30) / 300)
    return (
        Factor("C_Y", (190 / strength) ** 3, note),
        Factor("C_CS", speed, "0.1 up to 30 cycles/min, CR/300 up to 300, then (CR/300)³"),
        Factor("C_R", size(corrosion), "corrosion"),
        Factor("C_M", size(manufacture), "manufacture"),
    )
