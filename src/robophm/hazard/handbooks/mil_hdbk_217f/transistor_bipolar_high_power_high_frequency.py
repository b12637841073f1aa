"""MIL-HDBK-217F(2) §6.7, high-power bipolar transistors above 200 MHz, from 1 W on:

λp = λb · πT · πA · πM · πQ · πE   failures/10⁶ h
"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above, band
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import closing, stress_ratio
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import (
    RF_ENVIRONMENT,
    RF_QUALITY,
    junction_inputs,
    rf_quality,
    temperature_factor,
)
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(
    TITLE,
    "6.7",
    "6-12 … 6-13",
    "two transcriptions agree; no published answer to check against; the powers up to which λb is printed are from one "
    "program alone",
)

METALLIZATION = Table("high-power transistor metallization of πT", SOURCE, """
    gold      2903  0.1   2.0
    aluminum  5794  0.38  7.55
""", columns=("B", "scale up to S = 0.4", "slope above"))  # fmt: skip

MATCHING = Table("high-frequency transistor matching network πM", SOURCE, """
    input_and_output  1.0
    input             2.0
    none              4.0
""")  # fmt: skip

LARGEST_POWER = (1.0, 2.0, 3.0, 4.0, np.inf), (600.0, 300.0, 200.0, 100.0, 50.0)
"""Upper limits of the frequency [GHz], and the power up to which λb is printed [W]."""


@hazard_model(
    source=SOURCE,
    inputs={
        "frequency": Range(0.2, 5.0, "GHz", "frequency", monotone=1),
        "output_power": Range(1.0, 600.0, "W", "average output power", monotone=1),
        **junction_inputs(hottest=200.0),
        "metallization": Choice(METALLIZATION, "metallization", aliases={"aluminium": "aluminum"}),
        "voltage": Range(0.0, 1e4, "V", "operating VCE"),
        "rated_voltage": Range(1e-3, 1e4, "V", "breakdown BVCES, base shorted to emitter"),
        "application": Choice(("cw", "pulsed"), "continuous wave or pulsed", aliases={"continuous": "cw"}),
        "duty": Range(0.0, 1.0, "", "share of time in pulses; pulsed needs it", required=False, monotone=1),
        "matching": Choice(MATCHING, "internal matching network"),
        "quality": rf_quality(),
        "environment": environment_choice(RF_ENVIRONMENT),
    },
)
def hazard_rate(
    frequency: Array,
    output_power: Array,
    temperature: Array,
    power: Array,
    package: str,
    metallization: str,
    voltage: Array,
    rated_voltage: Array,
    application: str,
    matching: str,
    quality: str,
    environment: str,
    thermal_resistance: Array | None = None,
    duty: Array | None = None,
) -> Factor:
    """λp = λb · πT · πA · πM · πQ · πE

    λb = 0.032 · exp(0.354 · F + 0.00558 · P). πT holds for S = VCE/BVCES up to 0.55 and for junctions of 100 to
    200 °C only. Quality is the handbook's lower unless stated.
    """
    gigahertz, watts = np.asarray(frequency), np.asarray(output_power)
    largest = band(gigahertz, *LARGEST_POWER)
    return (
        Factor(
            "λb",
            0.032 * np.exp(0.354 * gigahertz + 0.00558 * watts),
            f"{span(gigahertz)} GHz, {span(watts)} W (printed up to 600 W at 1 GHz … 50 W above 4 GHz), failures/10⁶ h",
            outside=above(watts, largest),
            beyond=more_than("the output power", watts, f"the handbook's at {span(gigahertz)} GHz,", largest, "W"),
        )
        * temperature_factor(
            METALLIZATION.rows[metallization][0],
            temperature,
            power,
            package,
            thermal_resistance,
            reference=373.0,
            coolest=100.0,
            hottest=200.0,
        )
        * stress_factor(metallization, voltage, rated_voltage)
        * application_factor(application, duty)
        * Factor("πM", MATCHING[matching], f"matching {matching}")
        * closing(RF_QUALITY, quality, RF_ENVIRONMENT, environment)
    )


def stress_factor(metallization: str, voltage: Array, rated_voltage: Array) -> Factor:
    """The voltage's part of πT: A up to S = 0.4, slope · (S − 0.35) above, S = VCE/BVCES."""
    stress = stress_ratio(voltage, rated_voltage)
    _, scale, slope = METALLIZATION.rows[metallization]
    return Factor(
        "πT stress",
        np.where(above(stress, 0.4), slope * (stress - 0.35), scale),
        f"{metallization}, stress S = VCE/BVCES = {span(stress)} of at most 0.55",
        outside=above(stress, 0.55),
        beyond=more_than(
            "the operating voltage",
            np.abs(voltage),
            "0.55 of the breakdown voltage,",
            0.55 * np.asarray(rated_voltage),
            "V",
        ),
    )


def application_factor(application: str, duty: Array | None) -> Factor:
    """πA: 7.6 for a continuous wave, 0.06 · duty [%] + 0.40 for pulses, the duty counted as 1 to 30 %."""
    if application == "cw":
        return Factor("πA", 7.6, "continuous wave")
    if duty is None:
        raise ModelError("mil_hdbk_217f.transistor_bipolar_high_power_high_frequency: pulsed needs the input 'duty'")
    percent = np.clip(100 * np.asarray(duty), 1.0, 30.0)
    return Factor("πA", 0.06 * percent + 0.40, f"pulsed, {span(percent)} % of the time, counted as 1 to 30 %")
