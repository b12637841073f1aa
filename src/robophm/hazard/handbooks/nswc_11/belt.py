"""NSWC-11 §21, belts and pulleys:  λ = λB   failures/10⁶ h: base rates alone"""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.handbooks.nswc_11 import ONCE, PER_HOUR, TITLE
from robophm.hazard.model import Choice, Factor, hazard_model

SOURCE = Source(TITLE, "21", "base rates", f"{ONCE}; base rates only")

BASE_RATE = Table("belt drive base rate λB", SOURCE, """
    belt            40
    pulley_flat     0.8
    pulley_grooved  1.5
""")  # fmt: skip


@hazard_model(source=SOURCE, inputs={"part": Choice(BASE_RATE, "of the belt drive", aliases={"pulley": "pulley_flat"})})
def hazard_rate(part: str) -> Factor:
    """λ = λB"""
    return Factor("λB", BASE_RATE[part], f"{part}, failures/10⁶ h") * PER_HOUR
