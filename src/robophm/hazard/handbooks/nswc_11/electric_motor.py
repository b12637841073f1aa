"""NSWC-11 §14 Eq 14-1, motors:  λ = λM,B · C_SF + λ_WI + λ_BS + λ_ST + λ_AS + λ_BE + λ_GR + λ_C   failures/10⁶ h

Shaft, bearings, gear and capacitor count only where their rates are stated: as a rule they are parts of their own in a
design, and must not be in both. λ_WI = 10⁶/L_I · C_T · C_V · C_alt; 25,000 h of winding life is the handbook's default.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.nswc_11 import PER_HOUR, TITLE, TWICE, size
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(TITLE, "14", "Eqs 14-1 … 14-3, Tables 14-3, 14-4", TWICE)

KIND = Table("motor base rate λM,B", SOURCE, """
    dc               2.17   2  direct current, with brushes
    dc_brushless     1.75   0  direct current, brushless
    ac_single_phase  6.90   0  alternating current, one phase
    ac_polyphase     10.0   0  alternating current, several phases
""", columns=("λM,B", "brushes"))  # fmt: skip

SERVICE = Table("motor load C_SF", SOURCE, """
    uniform        1.0
    light_impact   1.5
    medium_impact  2.0
    heavy_impact   3.0
""")  # fmt: skip

STATOR = Factor("λ_ST", 0.001, "stator housing, failures/10⁶ h")


def _brushes(given: Mapping[str, Any]) -> tuple[float, str]:
    return KIND.cell(given["kind"], "brushes"), f"of {given['kind']}"


@hazard_model(
    source=SOURCE,
    inputs={
        "kind": Choice(
            KIND,
            "of motor",
            aliases={
                "brushed": "dc", "brushed dc": "dc", "bldc": "dc_brushless", "brushless": "dc_brushless",
                "brushless dc": "dc_brushless", "single phase": "ac_single_phase", "three phase": "ac_polyphase",
                "3 phase": "ac_polyphase",
            },
        ),
        "service": Choice(SERVICE, "how the load comes"),
        "temperature": Range(-60.0, 200.0, "degC", "ambient temperature", monotone=1, warmth="ambient"),
        "winding_life": Range(100.0, 1e7, "h", "L_I, of the insulation", default=25_000.0, monotone=-1),
        "voltage_deviation": Range(0.0, 0.5, "", "V_D/V_R, of one phase: share of the rating", default=0.0),
        "voltage_unbalance": Range(0.0, 3.0, "percent", "V_U, of several phases", default=0.0),
        "altitude": Range(0.0, 10_000.0, "m", "above the sea", default=0.0, monotone=1),
        "brushes": Range(0.0, 100.0, "", "how many; 2 of dc, else none", whole=True, required=False, monotone=1,
                         otherwise=_brushes),
        "shaft_rate": Range(0.0, 1.0, "1/h", "λ_AS, where it is no part of its own", default=0.0, monotone=1),
        "bearing_rate": Range(0.0, 1.0, "1/h", "λ_BE, of all, where no parts of their own", default=0.0, monotone=1),
        "gear_rate": Range(0.0, 1.0, "1/h", "λ_GR, where it is no part of its own", default=0.0, monotone=1),
        "capacitor_rate": Range(0.0, 1.0, "1/h", "λ_C, where it is no part of its own", default=0.0, monotone=1),
    },
)  # fmt: skip
def hazard_rate(
    kind: str,
    service: str,
    temperature: Array,
    winding_life: Array,
    voltage_deviation: Array,
    voltage_unbalance: Array,
    altitude: Array,
    shaft_rate: Array,
    bearing_rate: Array,
    gear_rate: Array,
    capacitor_rate: Array,
    brushes: Array | None = None,
) -> Factor:
    """λ = λM,B · C_SF + λ_WI + λ_BS + λ_ST + λ_AS + λ_BE + λ_GR + λ_C"""
    feet = size(altitude) / 0.3048
    number = KIND.cell(kind, "brushes") if brushes is None else size(brushes)
    match kind:
        case "ac_single_phase":
            supply = Factor("C_V", 2 ** (10 * size(voltage_deviation)), "2^(10 V_D/V_R)")
        case "ac_polyphase":
            supply = Factor("C_V", 1 + (0.40 * size(voltage_unbalance)) ** 2.5, "1 + (0.40 V_U)^2.5, V_U in %")
        case _:
            supply = Factor("C_V", 1.0, "1 of direct current")
    winding = (
        Factor("λ_WI,B", 1e6 / size(winding_life), "windings, 10⁶/L_I, failures/10⁶ h")
        * Factor("C_T", 2 ** ((np.asarray(temperature) - 40) / 10), "2^((T − 40 °C)/10)")
        * supply
        * Factor("C_alt", 1 + 8e-5 * np.maximum(feet - 3300, 0), "1 + 8·10⁻⁵ (a − 3300) above 3300 ft (1006 m)")
    )
    base = Factor("λM,B", KIND[kind], f"{KIND.notes[kind]}, failures/10⁶ h") * Factor("C_SF", SERVICE[service], service)
    stated = {"λ_AS": ("shaft", shaft_rate), "λ_BE": ("bearings", bearing_rate)}
    stated |= {"λ_GR": ("gear", gear_rate), "λ_C": ("capacitor", capacitor_rate)}
    total = base + winding + Factor("λ_BS", 3.2 * number, "3.2 of each brush, failures/10⁶ h") + STATOR
    for symbol, (of, rate) in stated.items():
        total = total + Factor(symbol, size(rate) * 1e6, f"{of}, as stated, failures/10⁶ h")
    return total * PER_HOUR
