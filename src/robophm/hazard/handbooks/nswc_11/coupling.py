"""NSWC-11 §17 Eq 17-2, mechanical couplings:  λ = 5.0 · C_SF + λ_GR + λ_SE + 0.001   failures/10⁶ cycles

Gears and seals of the coupling, where it has them, are stated per cycle. Where a maker states a life, the model is
general.b10_cycles; a universal joint is its bearings, seals and fasteners in series, each a part of the design.
"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.nswc_11 import PER_CYCLE, TITLE, TWICE, size
from robophm.hazard.model import Array, Choice, Factor, Range, hazard_model

SOURCE = Source(TITLE, "17", "Eq 17-2, Table 17-3", TWICE)

SERVICE = Table("coupling service C_SF", SOURCE, """
    uniform       1.1  1.2
    light_shock   1.2  1.3
    medium_shock  1.3  1.4
    heavy_shock   1.4  1.5
""", columns=("normal", "high"))  # fmt: skip

HOUSING = Factor("λ_H", 0.001, "housing, failures/10⁶ cycles")


@hazard_model(
    source=SOURCE,
    unit="1/cycle",
    inputs={
        "service": Choice(SERVICE, "how the load comes"),
        "torque": Choice(SERVICE.columns, "normal, or high in the user's own judgement", default="normal"),
        "gear_rate": Range(0.0, 1.0, "1/cycle", "λ_GR, of gears in it", default=0.0, monotone=1),
        "seal_rate": Range(0.0, 1.0, "1/cycle", "λ_SE, of seals in it", default=0.0, monotone=1),
    },
)
def hazard_rate(service: str, torque: str, gear_rate: Array, seal_rate: Array) -> Factor:
    """λ = 5.0 · C_SF + λ_GR + λ_SE + λ_H"""
    own = Factor("λ_CP,B", 5.0, "failures/10⁶ cycles") * Factor(
        "C_SF", SERVICE.cell(service, torque), f"{torque} torque"
    )
    gears = Factor("λ_GR", size(gear_rate) * 1e6, "gears, as stated, failures/10⁶ cycles")
    seals = Factor("λ_SE", size(seal_rate) * 1e6, "seals, as stated, failures/10⁶ cycles")
    return (own + gears + seals + HOUSING) * PER_CYCLE
