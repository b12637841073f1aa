"""MIL-HDBK-217F(2) §16.2, joints of one surface-mounted part:  λ = ECF · CR / Nf   1/h

Nf = 3.5 · (d / (0.65 h) · |αS · ΔT − αCC · (ΔT + Trise)|)^-2.26 · πLC cycles, and the characteristic life is α = Nf/CR.
The effective cumulative failures ECF come from the design life by α. No swing is printed for missiles and cannons.
The height of leaded joints, 8 mil, is from memory.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, steps
from robophm.hazard.handbooks.mil_hdbk_217f._factors import EFFECTIVE_FAILURES
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(
    TITLE,
    "16.2",
    "–",
    "two transcriptions agree; one worked example checked; the joint height of leaded parts, 8 mil, is from memory",
)

LEAD = Table("surface mount πLC, and joint height [mil]", SOURCE, """
    leadless   1     5
    J-lead     150   8  or S-lead
    gull-wing  5000  8
""", columns=("πLC", "height"))  # fmt: skip

PACKAGE = Table("surface mount αCC [ppm/K]", SOURCE, """
    plastic  7
    ceramic  6
""")  # fmt: skip

SUBSTRATE = Table("surface mount αS [ppm/K]", SOURCE, """
    fr4-laminate                      18
    fr4-multilayer                    20
    fr4-multilayer-copper-clad-invar  11
    ceramic-multilayer                7
    copper-clad-invar                 5
    copper-clad-molybdenum            5
    carbon-fiber-epoxy                1
    kevlar-fiber                      3
    quartz-fiber                      1
    glass-fiber                       5
    epoxy-glass                       15
    polyimide-glass                   13
    polyimide-kevlar                  6
    polyimide-quartz                  8
    epoxy-kevlar                      7
    alumina-ceramic                   7
    epoxy-aramid                      7
    polyimide-aramid                  6
    epoxy-quartz                      9
    fiberglass-teflon                 20
    porcelainized-copper-clad-invar   7
    fiberglass-ceramic                7
""")  # fmt: skip

CYCLING = Table("surface mount CR [cycles/h]", SOURCE, """
    automotive                 1.0
    consumer                   0.08
    computer                   0.17
    telecommunications         0.0042
    commercial-aircraft        0.25
    industrial                 0.021
    military-ground            0.03
    military-aircraft-cargo    0.12
    military-aircraft-fighter  0.5
""")  # fmt: skip

TEMPERATURE_SWING = Table("surface mount ΔT [K] by environment", SOURCE, """
    GB   7
    GF   21
    GM   26
    NS   26
    NU   61
    AIC  31
    AIF  31
    AUC  57
    AUF  57
    ARW  31
    SF   7
""")  # fmt: skip

MIL = 0.0254  # mm


def _height(given: Mapping[str, Any]) -> tuple[float, str]:
    return LEAD.cell(given["lead"], "height") * MIL, f"of a {given['lead']} part"


def _swing(given: Mapping[str, Any]) -> tuple[float, str]:
    environment = given["environment"]
    return TEMPERATURE_SWING[environment], f"the handbook's for the environment {environment}"


@hazard_model(
    source=SOURCE,
    inputs={
        "lead": Choice(
            LEAD,
            "lead of the package",
            aliases={
                "s-lead": "J-lead", "plcc": "J-lead", "soj": "J-lead", "soic": "gull-wing", "qfp": "gull-wing",
                "lqfp": "gull-wing", "tssop": "gull-wing", "qfn": "leadless",
            },
        ),
        "package": Choice(PACKAGE, "material of the package"),
        "substrate": Choice(SUBSTRATE, "material of the board", aliases={"fr4": "fr4-laminate"}),
        "package_side": Range(0.1, 200.0, "mm", "side of the package; d is half of it", monotone=1),
        "joint_height": Range(0.01, 5.0, "mm", "height of the joints; else by lead", required=False, monotone=-1,
                              otherwise=_height),
        "power": Range(0.0, 1e3, "W", "power dissipated"),
        "thermal_resistance": Range(0.0, 1e3, "K/W", "junction to case, θJC"),
        "temperature_swing": Range(
            0.0, 300.0, "K", "swing of the temperature in a cycle, ΔT; else the environment's", required=False,
            otherwise=_swing,
        ),
        "application": Choice(CYCLING, "what the equipment is for, which says how often it is switched"),
        "design_life": Range(1.0, 1e6, "h", "design life of the equipment", monotone=1),
        "environment": environment_choice(TEMPERATURE_SWING, but="none for MF, ML, CL"),
    },
)  # fmt: skip
def hazard_rate(
    lead: str,
    package: str,
    substrate: str,
    package_side: Array,
    power: Array,
    thermal_resistance: Array,
    application: str,
    design_life: Array,
    environment: str,
    joint_height: Array | None = None,
    temperature_swing: Array | None = None,
) -> Factor:
    """λ = ECF · CR / Nf"""
    height = np.asarray(LEAD.cell(lead, "height") * MIL if joint_height is None else joint_height)
    swing = np.asarray(TEMPERATURE_SWING[environment] if temperature_swing is None else temperature_swing)
    rise = np.asarray(thermal_resistance) * np.asarray(power)
    mismatch = np.abs(SUBSTRATE[substrate] * swing - PACKAGE[package] * (swing + rise)) * 1e-6
    strain = np.abs(package_side) / 2 / (0.65 * height) * mismatch
    per_cycle = strain**2.26 / 3.5 / LEAD[lead]  # 1/Nf, which has no pole where nothing moves
    rate = CYCLING[application]
    return (
        Factor("ECF", steps(EFFECTIVE_FAILURES, design_life * rate * per_cycle), "by design life over α = Nf/CR")
        * Factor("CR", rate, f"{application}, cycles/h")
        * Factor("1/Nf", per_cycle, f"{lead} {package} on {substrate}, 1/cycle")
    )
