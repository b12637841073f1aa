"""How a published case is put to a model: its source's names and words into ours, and nothing that is not known.

An adapter is strict: an input, factor or word that it does not know fails its case. What a case asks of a single factor
is answered by the model's own explanation, at the plausible inputs of that model but for those of the case.
"""

import functools
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from robophm.core.table import Table
from robophm.core.units import quantity
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import Model

DATA = Path(__file__).parents[2] / "data"

PER_MILLION = {"f/1e6h": 1.0, "f/1e6 rev": 1.0, "1": 1.0, "h": 1.0, "f/h": 1e-6, "f/cycle": 1e-6}
"""What turns the handbook's unit (failures per 10⁶, factors, hours) into that of a case."""

Inputs = Mapping[str, Any]
Given = Callable[[Any, Inputs], Inputs]
"""A value of a case, and all of them, as inputs of ours."""


def same(name: str) -> Given:
    """An input that we name as the source does, or only name otherwise."""
    return lambda value, _: {name: value}


def measured(name: str, unit: str) -> Given:
    """A number of that unit."""
    return lambda value, _: {name: f"{value} {unit}"}


def of_rated(name: str, rated: str, unit: str) -> Given:
    """A stress ratio: that much of a rating of 1."""
    return lambda value, _: {name: f"{value} {unit}", rated: f"1 {unit}"}


def worth(name: str, table: Table) -> Given:
    """A choice that the source names by its number: the first row that is worth it."""
    return lambda value, _: {name: next(word for word, number in table.items() if number == value)}


def word(name: str, words: Mapping[Any, str]) -> Given:
    """A choice that the source calls otherwise."""
    return lambda value, _: {name: words[value]}


def taken(value: Any, case: Inputs) -> Inputs:
    """An input that another one's entry uses."""
    return {}


@functools.cache
def plausible(model: str) -> Inputs:
    """Inputs as a robot might have them, of the model's file in tests/data."""
    found: Inputs = json.loads((DATA / "plausible_inputs" / f"{model}.json").read_text(encoding="utf-8"))
    return found


@dataclass(frozen=True)
class Adapter:
    """What the cases of one section name, and what one model takes."""

    kind: str
    """The model's name."""
    names: Mapping[str, Given]
    factors: Mapping[str, str | Callable[[Mapping[str, float]], float]] = field(default_factory=dict)
    """Their symbol, and ours or what it is of our factors."""
    unsaid: Inputs = field(default_factory=dict)
    """What cases of whole rates leave unsaid and the model needs; said why where it stands."""
    alike: Mapping[str, Callable[[str, Any], list[Inputs]]] = field(default_factory=dict)
    """Their name for a row of constants, and by our symbol all choices that have it: each must give the answer."""
    sum_of: str = ""
    """Their name for a list of parts, whose rates add up to the answer."""
    beyond: str = ""
    """Why a source goes beyond what we let into a design; then the model is asked as by a sensor."""

    @property
    def model(self) -> Model:
        return handbook_model(self.kind)

    def answers(self, case: Mapping[str, Any], *, checked: bool = True) -> list[float]:
        """What the model says, in the case's unit. ``checked`` inputs are those of a design, others as of a sensor."""
        inputs = dict(case["inputs"])
        factor = inputs.pop("factor", None)
        if factor is None:
            parts = inputs.pop(self.sum_of) if self.sum_of else [{}]
            found = [sum(self._rate({**inputs, **part}) for part in parts)]
        else:
            ours = self.factors[factor]
            known = [self.alike[name](str(ours), inputs.pop(name)) for name in self.alike if name in inputs]
            same_row = known[0] if known else [{}]
            assert same_row, f"no choice has the constants of {case['name']}"
            checked = checked and not self.beyond
            found = [self._factor(ours, {**row, **self._given(inputs)}, checked) for row in same_row]
        return [value * PER_MILLION[case["expected"]["unit"]] for value in found]

    def _rate(self, inputs: Inputs) -> float:
        settled = self.model.settle({**self.unsaid, **self._given(inputs)})
        return float(self.model.evaluate(settled).value) * 1e6

    def intermediate(self, case: Mapping[str, Any], name: str) -> float:
        """A factor on the way to a whole rate."""
        ours = self.factors[name]
        leaves = self.leaves(self.model.settle({**self.unsaid, **self._given(case["inputs"])}))
        return leaves[ours] if isinstance(ours, str) else ours(leaves)

    def _given(self, inputs: Inputs) -> Inputs:
        given: dict[str, Any] = {}
        for name, value in inputs.items():
            if name not in self.names:
                raise KeyError(f"{self.kind}: the published input '{name}' is not known here")
            more = self.names[name](value, inputs)
            assert not given.keys() & more.keys(), f"{self.kind}: '{name}' says again what was said"
            given |= more
        return given

    def _factor(self, ours: str | Callable[[Mapping[str, float]], float], given: Inputs, checked: bool) -> float:
        design = plausible(self.kind)
        if checked:
            settled = self.model.settle({**design, **given})
        else:
            numbers = {name: value for name, value in given.items() if name in self.model.numbers}
            settled = self.model.settle({**design, **{k: v for k, v in given.items() if k not in numbers}})
            settled |= {name: quantity(value, self.model.numbers[name].unit) for name, value in numbers.items()}
        leaves = self.leaves(settled)
        return leaves[ours] if isinstance(ours, str) else ours(leaves)

    def leaves(self, settled: Inputs) -> Mapping[str, float]:
        """The factors of the model's explanation, by symbol."""
        return {leaf.symbol: float(np.asarray(leaf.value)) for leaf in self.model.explain(settled).leaves()}
