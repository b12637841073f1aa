"""NSWC-11 §3, dynamic seals:  λ = 22.8   failures/10⁶ h: the base rate alone, without the handbook's factors"""

from __future__ import annotations

from robophm.core.table import Source
from robophm.hazard.handbooks.nswc_11 import ONCE, PER_HOUR, TITLE
from robophm.hazard.model import Factor, hazard_model


@hazard_model(source=Source(TITLE, "3", "base rate", f"{ONCE}; a base rate only, its factors are not here"), inputs={})
def hazard_rate() -> Factor:
    """λ = 22.8"""
    return Factor("λ_SE,B", 22.8, "base rate alone, failures/10⁶ h") * PER_HOUR
