"""MIL-HDBK-217F(2) chapter 5, microcircuits. One file here is one of its sections; this one holds what they share.

λp = (C1 · πT + C2 · πE) · πQ · πL   failures/10⁶ h, but for §5.3 and §5.5

That a junction ends at 175 °C and screening at 200 points is from memory. The printed rows of C2 end at 224 pins; its
equation, which is printed too, goes on, as ANSI/VITA 51.1 has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above, band, below
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, handbook_arrhenius, span
from robophm.hazard.model import Array, Choice, Factor, Input, Range, more_than

VITA = Source(
    "ANSI/VITA 51.1-2013 (R2018)",
    "2.1.2",
    "–",
    "single source: a public program's account of Table 2.1.2-1; the standard's own text was not to be had",
)
EXTENDED = "C1 beyond the handbook's bands is of ANSI/VITA 51.1, Table 2.1.2-1, by a single source"
LIMITS = "limits of 175 °C and 200 screening points from memory; C2 beyond 224 pins by the printed equation"
STATUS = f"C1, C2, πE, πQ: two transcriptions agree; {LIMITS}"
SOURCE = Source(TITLE, "5.8 … 5.11", "–", f"{STATUS}; families F and FTTL are printed both")

FAMILY = Table("microcircuit activation energy by logic family", SOURCE, """
    CMOS      0.35  1
    MOS       0.35  1  NMOS, PMOS, VHSIC CMOS
    BiCMOS    0.50  1  C1 is that of MOS
    bipolar   0.40  0  family unknown
    TTL       0.40  0
    ASTTL     0.40  0
    ALSTTL    0.40  0
    HTTL      0.40  0
    FTTL      0.40  0
    DTL       0.40  0
    CML       0.40  0
    ECL       0.40  0
    F         0.45  0
    LTTL      0.45  0
    STTL      0.45  0
    LSTTL     0.50  0
    IIL       0.60  0
    I3L       0.60  0
    ISL       0.60  0
""", columns=("Ea", "MOS"))  # fmt: skip

PACKAGE = Table("microcircuit C2 = a Np^b, and θJC by die", SOURCE, """
    DIP-hermetic  2.8e-4  1.08  11   28  solder or weld seal
    DIP-glass     9.0e-5  1.51  11   28  glass seal
    DIP-plastic   3.6e-4  1.08  11   28  non-hermetic
    PGA-hermetic  2.8e-4  1.08  10   20  solder or weld seal
    PGA-plastic   3.6e-4  1.08  10   20  non-hermetic
    SMT-hermetic  2.8e-4  1.08  10   20  chip carrier, leaded or leadless
    SMT-plastic   3.6e-4  1.08  10   20  non-hermetic, leaded or leadless
    flatpack      3.0e-5  1.82  10   22  axial leads on 50 mil centres
    can           3.0e-5  2.01  nan  70
""", columns=("a", "b", "large die", "small die"))  # fmt: skip

QUALITY = Table("microcircuit πQ", SOURCE, """
    S           0.25
    B           1.0
    B-1         2.0
    commercial  10    commercial, or unknown
    custom      nan   2 + 87 / points of the screening of §5.10
""")  # fmt: skip

ENVIRONMENT = Table("microcircuit πE", SOURCE, """
    GB   0.5
    GF   2
    GM   4
    NS   4
    NU   6
    AIC  4
    AIF  5
    AUC  5
    AUF  8
    ARW  8
    SF   0.5
    MF   5
    ML   12
    CL   220
""")  # fmt: skip

CASE_TEMPERATURE = Table("default case temperature [°C]", SOURCE, """
    GB   35
    GF   45
    GM   50
    NS   45
    NU   50
    AIC  60
    AIF  60
    AUC  75
    AUF  75
    ARW  60
    SF   35
    MF   50
    ML   60
    CL   45
""")  # fmt: skip

JUNCTION_LIMIT = 175.0

FAMILIES = Choice(FAMILY, "logic family", aliases={"nmos": "MOS", "pmos": "MOS", "hcmos": "CMOS", "unknown": "bipolar"})
PACKAGES = Choice(
    PACKAGE,
    "package and seal",
    aliases={
        "dip": "DIP-plastic", "pdip": "DIP-plastic", "cerdip": "DIP-glass", "qfp": "SMT-plastic", "lqfp": "SMT-plastic",
        "tqfp": "SMT-plastic", "qfn": "SMT-plastic", "so": "SMT-plastic", "soic": "SMT-plastic", "sot": "SMT-plastic",
        "ssop": "SMT-plastic", "tssop": "SMT-plastic", "bga": "SMT-plastic", "plcc": "SMT-plastic",
        "lccc": "SMT-hermetic", "to-5": "can",
    },
)  # fmt: skip
PINS = Range(1, 3000, "", "functional pins", whole=True, monotone=1)
POWER = Range(0.0, 1e3, "W", "power dissipated; 0 W where the case temperature is the junction's", monotone=1)


def _case(given: Mapping[str, Any]) -> tuple[float, str]:
    environment = given["environment"]
    return CASE_TEMPERATURE[environment], f"the handbook's for the environment {environment}"


def _resistance(given: Mapping[str, Any]) -> tuple[float, str]:
    package, die = given["package"], given["die"]
    return PACKAGE.cell(package, f"{die} die"), f"the handbook's for {package} with a {die} die"


CASE = Range(
    -55.0,
    JUNCTION_LIMIT,
    "degC",
    "case temperature; else the environment's",
    required=False,
    otherwise=_case,
    monotone=1,
    warmth="own",
)
RESISTANCE = Range(
    0.0,
    1e3,
    "K/W",
    "junction to case; else the package's; 70 K/W for one unknown",
    required=False,
    otherwise=_resistance,
    monotone=1,
)
YEARS = Range(0.0, 100.0, "year", "years for which the generic part has been in production")
QUALITIES = Choice(QUALITY, "quality level", default="commercial", aliases={"lower": "commercial"})
SCREENING = Range(1.0, 200.0, "", "points of the screening; quality 'custom' needs it", required=False)
ENVIRONMENTS = environment_choice(ENVIRONMENT)
COMMON: dict[str, Input] = {
    "package": PACKAGES,
    "die": Choice(("small", "large"), "die up to or above 14,400 mil² (9.3 mm²)", default="small"),
    "pins": PINS,
    "power": POWER,
    "case_temperature": CASE,
    "thermal_resistance": RESISTANCE,
    "years_in_production": YEARS,
    "quality": QUALITIES,
    "screening_points": SCREENING,
    "environment": ENVIRONMENTS,
}
"""The inputs of the sections that know a package; an unstated case temperature is the environment's."""


def die_factor(printed: Table, extended: Table, value: Array, column: str, note: str) -> Factor:
    """C1 by how complex a die is, in the handbook's bands and beyond them in those of ANSI/VITA 51.1."""
    bands = {float(limit): table.cell(limit, column) for table in (printed, extended) for limit in table}
    limits = tuple(bands)
    return Factor("C1", band(value, (*limits[:-1], np.inf), tuple(bands.values())), note)


def junction_temperature(
    package: str,
    die: str,
    power: Array,
    environment: str,
    case_temperature: Array | None,
    thermal_resistance: Array | None,
) -> Array:
    """TJ = TC + θJC · P [°C]. Raises ModelError for a large die in a can, which has no θJC."""
    if thermal_resistance is None:
        thermal_resistance = np.asarray(PACKAGE.cell(package, f"{die} die"))
        if np.isnan(thermal_resistance):
            raise ModelError(f"microcircuit: package {package} with a {die} die needs 'thermal_resistance' (K/W)")
    case = CASE_TEMPERATURE[environment] if case_temperature is None else case_temperature
    return case + thermal_resistance * np.asarray(power)


def temperature_factor(junction: Array, activation_energy: float, reference: float = 298.0) -> Factor:
    """πT = 0.1 at the reference [K]."""
    return Factor(
        "πT",
        0.1 * handbook_arrhenius(junction, activation_energy, reference),
        f"junction at {span(junction)} °C of at most {JUNCTION_LIMIT:g}, Ea = {activation_energy:g} eV",
        outside=above(junction, JUNCTION_LIMIT),
        beyond=more_than("the temperature of the junction", junction, "the handbook's", JUNCTION_LIMIT, "°C"),
    )


def package_factor(package: str, pins: Array) -> Factor:
    """C2 = a Np^b."""
    a, b = PACKAGE.cell(package, "a"), PACKAGE.cell(package, "b")
    return Factor("C2", a * np.power(np.maximum(pins, 0.0), b), f"{package}: {a:g} Np^{b:g}")


def environment_factor(environment: str) -> Factor:
    """πE of every section of the chapter."""
    return Factor("πE", ENVIRONMENT[environment], f"environment {environment}")


def quality_factor(quality: str, screening_points: Array | None) -> Factor:
    """The quality factor πQ of a microcircuit. Raises ModelError for custom screening without its points."""
    if quality != "custom":
        return Factor("πQ", QUALITY[quality], f"quality {quality}")
    if screening_points is None:
        raise ModelError("microcircuit: quality custom needs 'screening_points'")
    return Factor("πQ", 2 + 87 / np.maximum(screening_points, 1.0), "2 + 87 / points of the screening")


def learning_factor(years: Array) -> Factor:
    """πL: 2 in the first tenth of a year of production, 1 from the second year, as printed with steps at both."""
    years = np.asarray(years, dtype=float)
    between = 0.01 * np.exp(5.35 - 0.35 * np.clip(years, 0.1, 2.0))
    return Factor(
        "πL", np.where(above(years, 0.1), np.where(below(years, 2.0), between, 1.0), 2.0), "by years in production"
    )
