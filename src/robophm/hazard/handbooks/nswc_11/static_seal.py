"""NSWC-11 §3 Eq 3-7, static seals:  λ = 2.4 · C_P · C_Q · C_DL · C_H · C_f · C_v · C_T · C_N   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, above, below
from robophm.hazard.handbooks.nswc_11 import INCH, PER_HOUR, PSI, TITLE, product, size
from robophm.hazard.model import Array, Factor, Range, hazard_model

REYN_MINUTE = PSI * 1e6 * 60
"""Pound-force minutes per square inch [Pa·s]."""
CUBIC_INCH = INCH**3 / 1e3
"""Volume of a cubic inch [cm³]."""
GALLON = 3.785411784
"""Volume of a US gallon [L]."""


@hazard_model(
    source=Source(
        TITLE,
        "3",
        "Eq 3-7, Fig 3.10",
        "one transcription and an unrelated seal program agree; the handbook's own text could not be had",
    ),
    inputs={
        "pressure": Range(0.0, 100.0, "MPa", "P, across the seal", monotone=1),
        "allowable_leakage": Range(0.0, 1e4, "cm^3/min", "Q_f, at which it has failed", monotone=0),
        "inner_diameter": Range(0.5, 2000.0, "mm", "D_in, of the seal", monotone=1),
        "hardness": Range(0.01, 1e4, "MPa", "M, Meyer hardness of the softer material", monotone=1),
        "contact_pressure": Range(0.01, 1e4, "MPa", "C, by which it is pressed on", monotone=-1),
        "surface_finish": Range(0.005, 50.0, "um", "f, roughness", monotone=0),
        "viscosity": Range(1e-6, 100.0, "Pa*s", "ν, dynamic, of the fluid", monotone=-1),
        "temperature": Range(-100.0, 400.0, "degC", "T_O, of operation", monotone=1, warmth="own"),
        "rated_temperature": Range(-50.0, 500.0, "degC", "T_R, of the seal's material", monotone=-1),
        "filter_size": Range(0.1, 1000.0, "um", "C_0, of the fluid's filter", monotone=1),
        "flow": Range(1e-3, 1e5, "L/min", "F_R, of the fluid", monotone=1),
        "particles": Range(1e-6, 1e6, "", "N_10: under 10 µm per hour and gallon/min, from the pump", monotone=1),
    },
)
def hazard_rate(
    pressure: Array,
    allowable_leakage: Array,
    inner_diameter: Array,
    hardness: Array,
    contact_pressure: Array,
    surface_finish: Array,
    viscosity: Array,
    temperature: Array,
    rated_temperature: Array,
    filter_size: Array,
    flow: Array,
    particles: Array,
) -> Factor:
    """λ = 2.4 · C_P · C_Q · C_DL · C_H · C_f · C_v · C_T · C_N"""
    psi = np.maximum(pressure, 0) / PSI
    leak = np.maximum(allowable_leakage, 0) / CUBIC_INCH
    rough = size(surface_finish) / (INCH * 1e-3)
    spare = (np.asarray(rated_temperature) - np.asarray(temperature)) * 1.8
    return product(
        (
            Factor("λ_SE,B", 2.4, "failures/10⁶ h"),
            Factor("C_P", np.where(above(psi, 1500.0), (psi / 3000) ** 2, 0.25), "0.25 up to 1500 psi, then (P/3000)²"),
            Factor(
                "C_Q",
                np.where(above(leak, 0.03), 0.055 / np.maximum(leak, 0.03), 4.2 - 79 * np.minimum(leak, 0.03)),
                "0.055/Q_f above 0.03 in³/min, else 4.2 − 79 Q_f",
            ),
            Factor("C_DL", 1.1 * size(inner_diameter) / INCH + 0.32, "1.1 D_in + 0.32"),
            Factor("C_H", (size(hardness) / size(contact_pressure) / 0.55) ** 4.3, "((M/C)/0.55)^4.3"),
            Factor("C_f", np.where(below(rough, 15.0), 0.25, rough**1.65 / 353), "0.25 below 15 µin, then f^1.65/353"),
            Factor("C_v", 2e-8 / (size(viscosity) / REYN_MINUTE), "2·10⁻⁸/ν, ν in lbf·min/in²"),
            Factor(
                "C_T",
                np.where(above(spare, 40.0), 0.21, 2 ** -(np.minimum(spare, 40) / 18)),
                "0.21 where T_R − T_O is above 40 °F, else 2^(−(T_R − T_O)/18)",
            ),
            Factor(
                "C_N",
                (size(filter_size) / 10) ** 3 * size(flow) / GALLON * size(particles),
                "(C_0/10 µm)³ · F_R · N_10",
            ),
            PER_HOUR,
        )
    )
