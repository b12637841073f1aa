"""NSWC-11, solenoids:  λ = 2.77   failures/10⁶ operations"""

from __future__ import annotations

from robophm.core.table import Source
from robophm.hazard.handbooks.nswc_11 import ONCE, PER_CYCLE, TITLE
from robophm.hazard.model import Factor, hazard_model


@hazard_model(source=Source(TITLE, "5", "base rate", f"{ONCE}; its chapter is unconfirmed"), unit="1/cycle", inputs={})
def hazard_rate() -> Factor:
    """λ = 2.77"""
    return Factor("λ_SO", 2.77, "failures/10⁶ operations") * PER_CYCLE
