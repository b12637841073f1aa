from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.hazard.handbooks import handbook_model

DATA = Path(__file__).parents[3] / "data"


class Part:
    """A model of NSWC-11 at its plausible inputs, of which some are changed."""

    def __init__(self, name: str) -> None:
        self.model = handbook_model(f"nswc_11.{name}")
        file = DATA / "plausible_inputs" / f"nswc_11.{name}.json"
        self.plausible = json.loads(file.read_text(encoding="utf-8"))

    def inputs(self, **given: Any) -> dict[str, Any]:
        """Settled inputs; None leaves a plausible one out."""
        kept = {key: value for key, value in {**self.plausible, **given}.items() if value is not None}
        return self.model.settle(kept)

    def rate(self, **given: Any) -> float:
        return float(self.model.evaluate(self.inputs(**given)).value)

    def factors(self, **given: Any) -> dict[str, float]:
        """By symbol. A number that is no text is in the model's unit and is not checked, as of a sensor."""
        written = {key: value for key, value in given.items() if value is None or isinstance(value, str)}
        numbers = {key: value for key, value in given.items() if key not in written}
        assert set(numbers) <= set(self.model.numbers)
        leaves = self.model.explain({**self.inputs(**written), **numbers}).leaves()
        return {leaf.symbol: float(np.asarray(leaf.value)) for leaf in leaves}


@pytest.fixture(scope="session")
def part() -> Callable[[str], Part]:
    return Part
