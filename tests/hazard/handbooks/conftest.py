"""What the tests of the sections share: a model's factors, and the second transcription of the handbooks."""

import functools

import numpy as np
import pytest
from ruamel.yaml import YAML

from robophm.hazard.handbooks import handbook_model


class Section:
    """A model of MIL-HDBK-217F, its factors and its rate."""

    def __init__(self, name):
        self.model = handbook_model(f"mil_hdbk_217f.{name}")

    def factors(self, inputs, **measured):
        """The factors of inputs as a user writes them, then of numbers that are measured."""
        explained = self.model.explain({**self.model.settle(inputs), **measured})
        return {factor.symbol: np.asarray(factor.value, dtype=float) for factor in explained.leaves()}

    def rate(self, inputs):
        """Failures/10⁶ h."""
        return float(self.model.evaluate(self.model.settle(inputs)).value) * 1e6


@pytest.fixture
def section():
    """The section of a name."""
    return Section


@pytest.fixture(scope="session")
def factors():
    """The leaves of a model's explanation, by symbol."""
    return lambda model, inputs: {f.symbol: float(np.asarray(f.value)) for f in model.explain(inputs).leaves()}


@pytest.fixture(scope="session")
def second(shared):
    """The second transcription of the tables, by the name of its file."""
    return functools.cache(lambda name: YAML(typ="safe").load(shared / "handbook" / "tables" / f"{name}.yaml"))
