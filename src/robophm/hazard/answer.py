"""A model asked about one part: the answer, and all that it is made of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robophm.core.errors import ModelError
from robophm.hazard.model import Assumed, Choice, Model
from robophm.hazard.qualities import level


class FactorValue(NamedTuple):
    """One factor of an answer, with its symbol and meaning."""

    symbol: str
    value: float
    note: str
    """Meaning of the factor, and where it comes from."""


@dataclass(frozen=True)
class Answer:
    """The answer of a model for inputs as a person writes them."""

    model: Model
    value: float
    """Value of the model's result [``model.unit``]."""
    inputs: Mapping[str, str | float]
    """Inputs as they were taken: converted, checked, with defaults filled in."""
    assumed: Mapping[str, Assumed]
    """Values assumed for inputs that were not given, and why."""
    taken: Mapping[str, str]
    """Options that choices written otherwise were taken as, by the input's name."""
    factors: tuple[FactorValue, ...]
    """Factors in the order of the formula."""

    @property
    def unit(self) -> str:
        """Return the unit of the value."""
        return self.model.unit

    def __repr__(self) -> str:
        return (
            f"<Answer {self.value:.6g} {self.unit or 'times'} by {self.model.name}, {len(self.assumed)} inputs assumed>"
        )


def answer(model: Model, given: Mapping[str, object]) -> Answer:
    """The answer for inputs as written ('60 degC', 'CDR'). Raises ModelError and UnitError as ``Model.settle``."""
    said = given.get("quality")
    known = level(model, str(said), given) if said is not None else None
    inputs = model.settle({**given, "quality": known} if known else given)
    with np.errstate(all="ignore"):
        result = model.explain(inputs)
        value = float(np.asarray(result.value))
    if not math.isfinite(value):
        raise ModelError(f"{model.name} has no number for these inputs")
    choices = {name for name in given if isinstance(model.inputs[name], Choice)}
    taken = {name: str(inputs[name]) for name in given if name in choices and inputs[name] != given[name]}
    factors = tuple(FactorValue(one.symbol, float(np.asarray(one.value)), one.note) for one in result.leaves())
    return Answer(model, value, inputs, model.assumed(given.keys(), inputs), taken, factors)
