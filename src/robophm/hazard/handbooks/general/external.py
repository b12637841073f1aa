"""A rate that the user has computed by a standard whose tables are not shipped here; where from must be said."""

from __future__ import annotations

from robophm.core.table import Source
from robophm.hazard.model import Array, Choice, Factor, Note, Range, hazard_model

STANDARDS = ("FIDES", "Telcordia SR-332", "SN 29500", "IEC TR 62380", "IEC 61709", "NPRD", "other")


@hazard_model(
    source=Source("the user's own data", "–", "–", "as stated in the design"),
    inputs={
        "rate": Range(0.0, 1e6, "1/h", "hazard rate as computed by the standard"),
        "standard": Choice(
            STANDARDS,
            "by which it was computed",
            aliases={
                "telcordia": "Telcordia SR-332", "sr-332": "Telcordia SR-332", "bellcore": "Telcordia SR-332",
                "siemens sn 29500": "SN 29500", "sn29500": "SN 29500",
                "62380": "IEC TR 62380", "61709": "IEC 61709", "nprd-2016": "NPRD",
            },
        ),
        "source": Note("edition, page or file, conditions: where the figure can be looked up"),
    },
)  # fmt: skip
def hazard_rate(rate: Array, standard: str, source: str) -> Factor:
    """λ as stated."""
    return Factor("λ", rate, f"{standard}: {source}")
