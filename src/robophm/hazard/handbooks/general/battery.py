"""Batteries:  λ = λ0 · 10⁻⁹/h. Catastrophic failures of one battery alone; wear-out is another failure mode."""

from __future__ import annotations

from robophm.core.table import Source, Table
from robophm.hazard.model import Choice, Factor, hazard_model

PER_BILLION_HOURS = 1e-9

SOURCE = Source(
    "Prognostic & Health Management Tool for ROS (2020)", "3.1.1", "Table 4", "single source; IEC TR 62380 has the like"
)

BASE_RATE = Table("battery base rate λ0", SOURCE, """
    primary          20   primary cells
    nickel_cadmium   100  secondary cells, Ni-Cd
    lithium_ion      150  secondary cells, Li-ion
""")  # fmt: skip


@hazard_model(
    source=SOURCE,
    inputs={
        "chemistry": Choice(
            BASE_RATE,
            "kind of cells",
            aliases={
                "primary cell": "primary", "alkaline": "primary", "nicd": "nickel_cadmium", "ni-cd": "nickel_cadmium",
                "liion": "lithium_ion", "li-ion": "lithium_ion", "lipo": "lithium_ion", "li-po": "lithium_ion",
                "li-polymer": "lithium_ion", "lifepo4": "lithium_ion",
            },
        ),
    },
)  # fmt: skip
def hazard_rate(chemistry: str) -> Factor:
    """λ = λ0 · 10⁻⁹/h"""
    base = Factor("λ0", BASE_RATE[chemistry], f"{BASE_RATE.notes[chemistry]}, failures/10⁹ h")
    return base * Factor("10⁻⁹", PER_BILLION_HOURS, "FIT to 1/h")
