"""MIL-HDBK-217F(2) §10.1, capacitors:  λp = λb · πT · πC · πV · πSR · πQ · πE   failures/10⁶ h"""

from __future__ import annotations

import numpy as np

from robophm.core.errors import ModelError
from robophm.core.table import Source, Table, above, band
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, handbook_arrhenius, span
from robophm.hazard.model import PER_MILLION_HOURS, Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(TITLE, "10.1", "10-1 … 10-6", "three transcriptions agree; checked against Appendix A")

STYLE = Table("capacitor style", SOURCE, """
    CP   0.00037  1 1 1 0   MIL-C-25      paper, by-pass
    CA   0.00037  1 1 1 0   MIL-C-12889   paper, by-pass, RFI
    CZ   0.00037  1 1 1 0   MIL-C-11693   feed-through
    CZR  0.00037  1 1 1 0   MIL-C-11693   feed-through, ER
    CQ   0.00051  1 1 1 0   MIL-C-19978   paper and plastic film
    CQR  0.00051  1 1 1 0   MIL-C-19978   paper and plastic film, ER
    CH   0.00037  1 1 1 0   MIL-C-18312   metallized paper and plastic
    CHR  0.00051  1 1 1 0   MIL-C-39022   metallized paper and plastic, ER
    CFR  0.00051  1 1 1 0   MIL-C-55514   plastic film, non-hermetic
    CRH  0.00051  1 1 1 0   MIL-C-83421   supermetallized plastic
    CM   0.00076  2 1 2 0   MIL-C-5       mica
    CMR  0.00076  2 1 2 0   MIL-C-39001   mica, ER
    CB   0.00076  2 1 2 0   MIL-C-10950   mica, button
    CY   0.00076  2 1 2 0   MIL-C-11272   glass
    CYR  0.00076  2 1 2 0   MIL-C-23269   glass, ER
    CK   0.00099  2 1 3 0   MIL-C-11015   ceramic, general purpose
    CKR  0.00099  2 1 3 0   MIL-C-39014   ceramic, general purpose, ER
    CC   0.00099  2 1 3 0   MIL-C-20      ceramic, temperature compensating
    CCR  0.00099  2 1 3 0   MIL-C-20      ceramic, temperature compensating, ER
    CDR  0.0020   2 1 3 0   MIL-C-55681   ceramic chip (MLCC)
    CSR  0.00040  1 2 4 1   MIL-C-39003   solid tantalum, ER
    CWR  0.00005  1 2 4 1   MIL-C-55365   tantalum chip
    CL   0.00040  1 2 4 0   MIL-C-3965    wet tantalum, foil and slug
    CLR  0.00040  1 2 4 0   MIL-C-39006   wet tantalum, ER
    CRL  0.00040  1 2 4 0   MIL-C-83500   wet tantalum, tantalum case
    CU   0.00012  2 2 1 0   MIL-C-39018   aluminium oxide
    CUR  0.00012  2 2 1 0   MIL-C-39018   aluminium oxide, ER
    CE   0.00012  2 2 1 0   MIL-C-62      aluminium, dry electrolyte
    CV   0.0079   1 1 5 0   MIL-C-81      variable, ceramic
    PC   0.0060   2 1 5 0   MIL-C-14409   variable, piston, tubular trimmer
    CT   0.0000072 2 1 5 0  MIL-C-92      variable, air trimmer
    CG   0.0060   1 1 5 0   MIL-C-23183   variable, gas or vacuum
""", columns=("λb", "πT column", "πC column", "πV column", "πSR applies"))  # fmt: skip

QUALITY = Table("capacitor quality πQ", SOURCE, """
    D           0.001
    C           0.01
    S           0.03
    B           0.03
    R           0.1
    P           0.3
    M           1.0
    L           1.5
    non-ER      3.0   military specification without established reliability
    commercial  10.0  commercial, or unknown
""")  # fmt: skip

ENVIRONMENT = Table("capacitor environment πE", SOURCE, """
    GB   1.0
    GF   10.0
    GM   20.0
    NS   7.0
    NU   15.0
    AIC  12.0
    AIF  15.0
    AUC  25.0  Appendix A of the handbook needs 25
    AUF  30.0
    ARW  40.0
    SF   0.5
    MF   20.0
    ML   50.0
    CL   570.0
""")  # fmt: skip

ACTIVATION_ENERGY = {1: 0.15, 2: 0.35}  # eV, by πT column
CAPACITANCE_EXPONENT = {1: 0.09, 2: 0.23}  # by πC column
VOLTAGE_STRESS = {1: (0.6, 5), 2: (0.6, 10), 3: (0.6, 3), 4: (0.6, 17), 5: (0.5, 3)}  # (S/s₀)ⁿ + 1
SERIES_RESISTANCE = (0.1, 0.2, 0.4, 0.6, 0.8, np.inf), (3.3, 2.7, 2.0, 1.3, 1.0, 0.66)


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(
            STYLE,
            "military style of the capacitor",
            aliases={
                "mlcc": "CDR",
                "ceramic chip": "CDR",
                "chip ceramic": "CDR",
                "aluminium electrolytic": "CU",
                "aluminum electrolytic": "CU",
                "electrolytic": "CU",
                "tantalum chip": "CWR",
                "smd tantalum": "CWR",
                "solid tantalum": "CSR",
                "film": "CFR",
                "plastic film": "CFR",
                "mica": "CM",
            },
        ),
        "capacitance": Range(1e-6, 1.2e5, "uF", "capacitance", monotone=1),
        "temperature": Range(-55.0, 150.0, "degC", "ambient temperature", monotone=1, warmth="ambient"),
        "dc_voltage": Range(0.0, 1e5, "V", "applied DC voltage", monotone=1, stress="voltage"),
        "ac_voltage": Range(0.0, 1e5, "V", "applied AC voltage, rms", default=0.0, monotone=1),
        "rated_voltage": Range(1e-3, 1e5, "V", "rated voltage", monotone=-1),
        "series_resistance": Range(
            0.0,
            1e9,
            "ohm/V",
            "circuit resistance by applied voltage; CSR and CWR need it",
            required=False,
            monotone=-1,
        ),
        "quality": Choice(QUALITY, "quality level", default="commercial"),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    style: str,
    capacitance: Array,
    temperature: Array,
    dc_voltage: Array,
    ac_voltage: Array,
    rated_voltage: Array,
    quality: str,
    environment: str,
    series_resistance: Array | None = None,
) -> Factor:
    """λp = λb · πT · πC · πV · πSR · πQ · πE"""
    column = {name: int(STYLE.cell(style, f"{name} column")) for name in ("πT", "πC", "πV")}
    # magnitudes: a reversed voltage that is measured is flagged, and must not make the rate negative
    applied = np.abs(dc_voltage) + np.sqrt(2) * np.abs(ac_voltage)
    stress = applied / np.asarray(rated_voltage)
    reference, exponent = VOLTAGE_STRESS[column["πV"]]
    if STYLE.cell(style, "πSR applies"):
        if series_resistance is None:
            raise ModelError(f"mil_hdbk_217f.capacitor: style {style} needs 'series_resistance' (ohm/V of circuit)")
        series = Factor("πSR", band(series_resistance, *SERIES_RESISTANCE), "table πSR, p. 10-6")
    else:
        series = Factor("πSR", 1.0, "1 for every style but CSR and CWR")
    return (
        Factor("λb", STYLE[style], f"{style}: {STYLE.notes[style]}, failures/10⁶ h")
        * Factor(
            "πT",
            handbook_arrhenius(temperature, ACTIVATION_ENERGY[column["πT"]]),
            f"column {column['πT']}, Ea = {ACTIVATION_ENERGY[column['πT']]} eV",
        )
        * Factor("πC", np.power(capacitance, CAPACITANCE_EXPONENT[column["πC"]]), f"column {column['πC']}, C in µF")
        * Factor(
            "πV",
            (stress / reference) ** exponent + 1,
            f"column {column['πV']}, stress S = {span(stress)} of at most 1",
            outside=above(stress, 1.0),
            beyond=more_than(
                f"the applied voltage{' (DC and peak AC)' if np.any(ac_voltage) else ''}",
                applied,
                "the rated voltage",
                rated_voltage,
                "V",
            ),
        )
        * series
        * Factor("πQ", QUALITY[quality], f"quality {quality}")
        * Factor("πE", ENVIRONMENT[environment], f"environment {environment}")
        * Factor("10⁻⁶", PER_MILLION_HOURS, "failures/10⁶ h to 1/h")
    )
