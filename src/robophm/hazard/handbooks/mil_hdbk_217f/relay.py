"""MIL-HDBK-217F(2) §13.1, mechanical relays:  λp = λb · πL · πC · πCYC · πF · πQ · πE   failures/10⁶ h

Solid-state, solid-state time-delay and hybrid relays are §13.2. The 2020 tool took πL for (S/d)² + 1.
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, handbook_arrhenius, per_million_hours
from robophm.hazard.handbooks.mil_hdbk_217f._contacts import LOAD, load_factor
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(
    TITLE,
    "13.1",
    "–",
    "two transcriptions agree; checked against Appendix A, which reproduces with a rating of 85 °C; no πE for CL",
)

CONTACT_FORM = Table("relay πC", SOURCE, """
    SPST  1.0
    DPST  1.5
    SPDT  1.75
    3PST  2.0
    4PST  2.5
    DPDT  3.0
    3PDT  4.25
    4PDT  5.5
    6PDT  8.0
""")  # fmt: skip

CONSTRUCTION = Table("relay πF by rating, application and construction", SOURCE, """
    signal-dry-armature-long          4    signal current, dry circuit, dry armature (long)
    signal-dry-reed                   6    signal current, dry circuit, dry reed
    signal-mercury-wetted             1    signal current, dry circuit, mercury wetted
    signal-magnetic-latching          4    signal current, dry circuit, magnetic latching
    signal-balanced-armature          7    signal current, dry circuit, balanced armature
    signal-solenoid                   7    signal current, dry circuit, solenoid
    general-armature-long             3    0–5 A, general purpose, armature (long)
    general-balanced-armature         5    0–5 A, general purpose, balanced armature
    general-solenoid                  6    0–5 A, general purpose, solenoid
    sensitive-armature                5    0–5 A, sensitive (0–100 mW), armature
    sensitive-mercury-wetted          2    0–5 A, sensitive (0–100 mW), mercury wetted
    sensitive-magnetic-latching       6    0–5 A, sensitive (0–100 mW), magnetic latching
    sensitive-meter-movement          100  0–5 A, sensitive (0–100 mW), meter movement
    sensitive-balanced-armature       10   0–5 A, sensitive (0–100 mW), balanced armature
    polarized-armature-short          10   0–5 A, polarized, armature (short)
    polarized-meter-movement          100  0–5 A, polarized, meter movement
    vibrating-dry-reed                6    0–5 A, vibrating, dry reed
    vibrating-mercury-wetted          1    0–5 A, vibrating, mercury wetted
    high-speed-armature               25   0–5 A, high speed, armature
    high-speed-dry-reed               6    0–5 A, high speed, dry reed
    thermal-time-delay-bimetal        10   0–5 A, thermal time delay, bimetal
    electronic-time-delay             9    0–5 A, electronic time delay, not thermal
    latching-dry-reed                 10   0–5 A, magnetic latching, dry reed
    latching-mercury-wetted           5    0–5 A, magnetic latching, mercury wetted
    latching-balanced-armature        5    0–5 A, magnetic latching, balanced armature
    high-voltage-vacuum-glass         20   5–20 A, high voltage, vacuum glass
    high-voltage-vacuum-ceramic       5    5–20 A, high voltage, vacuum ceramic
    medium-power-armature             3    5–20 A, medium power, armature
    medium-power-mercury-wetted       1    5–20 A, medium power, mercury wetted
    medium-power-magnetic-latching    2    5–20 A, medium power, magnetic latching
    medium-power-mechanical-latching  3    5–20 A, medium power, mechanical latching
    medium-power-balanced-armature    2    5–20 A, medium power, balanced armature
    medium-power-solenoid             2    5–20 A, medium power, solenoid
    contactor-armature-short          7    25–600 A, contactor, armature (short)
    contactor-mechanical-latching     12   25–600 A, contactor, mechanical latching
    contactor-balanced-armature       10   25–600 A, contactor, balanced armature
    contactor-solenoid                5    25–600 A, contactor, solenoid
""")  # fmt: skip

QUALITY = Table("relay πQ", SOURCE, """
    R           0.10
    P           0.30
    X           0.45
    U           0.60
    M           1.0
    L           1.5
    MIL-SPEC    1.5  without established reliability
    commercial  2.9
""")  # fmt: skip

ENVIRONMENT = Table("relay πE", SOURCE, """
    GB   1
    GF   2
    GM   15
    NS   8
    NU   27
    AIC  7
    AIF  9
    AUC  11
    AUF  12
    ARW  46
    SF   0.5
    MF   25
    ML   66
""")  # fmt: skip

RATED_TEMPERATURE = {"85 degC": (85.0, 0.19), "125 degC": (125.0, 0.17)}  # °C, eV


@hazard_model(
    source=SOURCE,
    inputs={
        "construction": Choice(CONSTRUCTION, "application and construction"),
        "rated_temperature": Choice(
            tuple(RATED_TEMPERATURE),
            "rated ambient temperature",
            aliases={"85": "85 degC", "85 °c": "85 degC", "125": "125 degC", "125 °c": "125 degC"},
        ),
        "temperature": Range(
            -55.0, 125.0, "degC", "ambient temperature, at most the rated one", monotone=1, warmth="ambient"
        ),
        "load": Choice(LOAD, "kind of load"),
        "load_current": Range(0.0, 1e3, "A", "current of the load", monotone=1, stress="current"),
        "rated_current": Range(1e-3, 1e3, "A", "rated resistive current", monotone=-1),
        "contact_form": Choice(CONTACT_FORM, "form of the contacts"),
        "cycling": Range(0.0, 1e5, "cycle/h", "how often it switches", monotone=1),
        "quality": Choice(QUALITY, "quality level", default="commercial"),
        "environment": environment_choice(ENVIRONMENT, but="none for CL"),
    },
)
def hazard_rate(
    construction: str,
    rated_temperature: str,
    temperature: Array,
    load: str,
    load_current: Array,
    rated_current: Array,
    contact_form: str,
    cycling: Array,
    quality: str,
    environment: str,
) -> Factor:
    """λp = λb · πL · πC · πCYC · πF · πQ · πE"""
    rating, activation_energy = RATED_TEMPERATURE[rated_temperature]
    return (
        Factor(
            "λb",
            0.0059 * handbook_arrhenius(temperature, activation_energy),
            f"rated {rating:g} °C, at most that, Ea = {activation_energy} eV, failures/10⁶ h",
            outside=above(temperature, rating),
            beyond=more_than("the ambient temperature", temperature, "the rated temperature", rating, "°C"),
        )
        * load_factor(load, load_current, rated_current)
        * Factor("πC", CONTACT_FORM[contact_form], contact_form)
        * cycling_factor(cycling, quality)
        * Factor("πF", CONSTRUCTION[construction], CONSTRUCTION.notes[construction])
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * per_million_hours()
    )


def cycling_factor(cycling: Array, quality: str) -> Factor:
    """πCYC: one rule for commercial quality, another for every military one."""
    cycles = np.asarray(cycling, dtype=float)
    if quality == "commercial":
        value = np.where(above(cycles, 1000.0), (cycles / 100) ** 2, np.maximum(cycles / 10, 1.0))
        return Factor("πCYC", value, "commercial: 1 below 10 an hour, N/10 to 1000, (N/100)² above")
    return Factor("πCYC", np.maximum(cycles / 10, 0.1), "MIL-SPEC: 0.1 below 1 an hour, N/10 above")
