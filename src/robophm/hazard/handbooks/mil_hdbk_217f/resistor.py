"""MIL-HDBK-217F(2) §9.1, resistors, thermistors and potentiometers:

λp = λb · πT · πP · πS · πQ · πE   failures/10⁶ h
"""

from __future__ import annotations

import numpy as np

from robophm.core.table import Source, Table, above
from robophm.hazard.environments import environment_choice
from robophm.hazard.handbooks.mil_hdbk_217f import TITLE, handbook_arrhenius, span
from robophm.hazard.handbooks.mil_hdbk_217f._factors import STEEPEST, closing, stress_ratio
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model, more_than

SOURCE = Source(TITLE, "9.1", "9-1 … 9-3", "two transcriptions agree; five styles checked against Appendix A")

STYLE = Table("resistor style", SOURCE, """
    RC   0.0017  1 2  MIL-R-11     composition
    RCR  0.0017  1 2  MIL-R-39008  composition, ER
    RL   0.0037  2 1  MIL-R-22684  film, insulated
    RLR  0.0037  2 1  MIL-R-39017  film, ER
    RN   0.0037  2 1  MIL-R-10509  film (R, C, N)
    RNR  0.0037  2 1  MIL-R-55182  film, ER
    RM   0.0037  2 1  MIL-R-55342  film, chip
    RD   0.0037  0 1  MIL-R-11804  film, power
    RZ   0.0019  1 0  MIL-R-83401  film, network
    RB   0.0024  2 1  MIL-R-93     wirewound, accurate
    RBR  0.0024  2 1  MIL-R-39005  wirewound, accurate, ER
    RW   0.0024  2 2  MIL-R-26     wirewound, power
    RWR  0.0024  2 2  MIL-R-39007  wirewound, power, ER
    RE   0.0024  2 2  MIL-R-18546  wirewound, power, chassis mounted
    RER  0.0024  2 2  MIL-R-39009  wirewound, power, chassis mounted, ER
    RTH  0.0019  0 0  MIL-R-23648  thermistor
    RT   0.0024  2 1  MIL-R-27208  variable, wirewound
    RTR  0.0024  2 1  MIL-R-39015  variable, wirewound, ER (trimmer)
    RR   0.0024  2 1  MIL-R-12934  variable, wirewound, precision
    RA   0.0024  1 1  MIL-R-19     variable, wirewound, semiprecision
    RK   0.0024  1 1  MIL-R-39002  variable, wirewound, semiprecision
    RP   0.0024  2 1  MIL-R-22     variable, wirewound, power
    RJ   0.0037  2 1  MIL-R-22097  variable, non-wirewound (trimmer)
    RJR  0.0037  2 1  MIL-R-39035  variable, non-wirewound, ER (trimmer)
    RV   0.0037  2 1  MIL-R-94     variable, composition
    RQ   0.0037  1 1  MIL-R-39023  variable, non-wirewound, precision
    RVC  0.0037  1 1  MIL-R-23285  variable, film
""", columns=("λb", "πT column", "πS column"))  # fmt: skip

QUALITY = Table("resistor quality πQ", SOURCE, """
    S           0.03
    R           0.1
    P           0.3
    M           1.0
    non-ER      3.0   military specification without established reliability
    commercial  10.0  commercial, or unknown
""")  # fmt: skip

ENVIRONMENT = Table("resistor environment πE", SOURCE, """
    GB   1.0
    GF   4.0
    GM   16.0
    NS   12.0
    NU   42.0
    AIC  18.0
    AIF  23.0
    AUC  31.0
    AUF  43.0
    ARW  63.0
    SF   0.5
    MF   37.0
    ML   87.0
    CL   1728.0
""")  # fmt: skip

ACTIVATION_ENERGY = {0: 0.0, 1: 0.2, 2: 0.08}  # eV, by πT column; of column 0 the factor is 1
POWER_STRESS = {0: (1.0, 0.0), 1: (0.71, 1.1), 2: (0.54, 2.04)}  # a · exp(b · S), by πS column
ALIASES = {
    "chip": "RM",
    "chip resistor": "RM",
    "smd": "RM",
    "thick film": "RM",
    "thin film": "RM",
    "film": "RL",
    "metal film": "RN",
    "carbon film": "RL",
    "composition": "RC",
    "carbon composition": "RC",
    "network": "RZ",
    "resistor network": "RZ",
    "wirewound": "RW",
    "wirewound power": "RW",
    "thermistor": "RTH",
    "ntc": "RTH",
    "ptc": "RTH",
    "trimmer": "RJ",
    "trimpot": "RJ",
    "cermet trimmer": "RJ",
    "wirewound trimmer": "RT",
    "potentiometer": "RV",
    "wirewound potentiometer": "RR",
}


@hazard_model(
    source=SOURCE,
    inputs={
        "style": Choice(STYLE, "military style of the resistor", aliases=ALIASES),
        "temperature": Range(
            -55.0,
            150.0,
            "degC",
            "case temperature; the ambient's for parts that hardly warm themselves",
            monotone=1,
            warmth="own",
        ),
        "power": Range(1e-9, 1e4, "W", "power dissipated", monotone=1),
        "rated_power": Range(1e-6, 1e4, "W", "rated power", monotone=-1),
        "quality": Choice(QUALITY, "quality level", default="commercial"),
        "environment": environment_choice(ENVIRONMENT),
    },
)
def hazard_rate(
    style: str, temperature: Array, power: Array, rated_power: Array, quality: str, environment: str
) -> Factor:
    """λp = λb · πT · πP · πS · πQ · πE

    πP counts the watts dissipated, not the rating, of a thermistor too. Quality is commercial unless stated, as the
    handbook has it for unknown.
    """
    temperature_column, stress_column = (int(STYLE.cell(style, f"{name} column")) for name in ("πT", "πS"))
    energy, (scale, slope) = ACTIVATION_ENERGY[temperature_column], POWER_STRESS[stress_column]
    stress = stress_ratio(power, rated_power)
    return (
        Factor("λb", STYLE[style], f"{style}: {STYLE.notes[style]}, failures/10⁶ h")
        * Factor(
            "πT",
            handbook_arrhenius(temperature, energy),
            f"column {temperature_column}, Ea = {energy} eV" if energy else f"1 for style {style}",
        )
        * Factor("πP", np.abs(power) ** 0.39, "dissipated watts to the power 0.39")
        * Factor(
            "πS",
            scale * np.exp(slope * np.minimum(stress, STEEPEST)),
            f"column {stress_column}, stress S = {span(stress)} of at most 1",
            outside=above(stress, 1.0),
            beyond=more_than("the power dissipated", np.abs(power), "the rated power", rated_power, "W"),
        )
        * closing(QUALITY, quality, ENVIRONMENT, environment)
    )
