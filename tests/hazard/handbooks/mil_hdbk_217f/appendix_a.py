"""The generic rates that Appendix A of MIL-HDBK-217F Notice 2 prints, as tests compare our models with them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from robophm.hazard.handbooks import handbook_model


class Printed:
    """A file of printed rates [failures/10⁶ h]: its rows by name, and every rate that is not disputed."""

    def __init__(self, file: str) -> None:
        data = json.loads((Path(__file__).parents[3] / "data" / file).read_text(encoding="utf-8"))
        self.junction: dict[str, float] = data["junction_temperature"]
        self.tolerance: dict[str, float] = data["tolerance"]
        self.rows: dict[str, Any] = data["rows"]
        self.rates = [
            (name, environment)
            for name, row in self.rows.items()
            for environment in row["rates"]
            if environment not in row["disputed"]
        ]

    @property
    def counts(self) -> tuple[int, int, int]:
        """Rows, rates that are compared, and rates that are disputed."""
        return len(self.rows), len(self.rates), sum(len(row["disputed"]) for row in self.rows.values())


def rate(name: str, given: dict[str, Any]) -> float:
    """What our model gives [failures/10⁶ h]."""
    model = handbook_model(name)
    return float(model.evaluate(model.settle(given)).value) * 1e6
