"""The hazard models as forms: one description of each, which the page draws, and its answer with every factor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import Field

from robophm.core.table import Table
from robophm.hazard.acceleration import ACCELERATIONS
from robophm.hazard.answer import answer as answer_of
from robophm.hazard.formula import formula_model
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Choice, Model, Note, Range
from robophm.web.shapes import Shape


class FormInput(Shape):
    """An input of a model, as a form asks for it."""

    name: str
    kind: Literal["number", "choice", "words"]
    description: str
    required: bool
    unit: str = ""
    low: float | None = None
    high: float | None = None
    whole: bool = False
    """Whether the input counts things."""
    default: str | float | None = None
    options: list[str] = []
    meanings: dict[str, str] = {}
    """Meanings of options, where the handbook says more."""
    aliases: dict[str, str] = {}
    """Names that people use for an option, and the option."""
    measurable: bool = False
    """Whether a sensor can be bound to it."""


class Form(Shape):
    """A model, as a form asks for its inputs."""

    name: str
    handbook: str
    title: str
    formula: str
    source: str
    unit: str
    inputs: list[FormInput]


class ModelName(Shape):
    """A model as the list of all models shows it."""

    name: str
    handbook: str
    title: str
    formula: str


class Library(Shape):
    """All models and accelerations."""

    models: list[ModelName]
    accelerations: list[Form]


class RateAsked(Shape):
    """Inputs as a person writes them: '60 degC', 'CDR'."""

    model: Annotated[str, Field(max_length=200)]
    inputs: Annotated[dict[str, str | float], Field(max_length=100)]


class FormulaAsked(Shape):
    """A user's own formula with its variables."""

    formula: Annotated[str, Field(max_length=2000)]
    unit: Annotated[str, Field(max_length=60)]
    variables: Annotated[dict[str, float], Field(max_length=50)]


class FactorValue(Shape):
    """A factor of a model's formula with its value."""

    symbol: str
    value: float | None
    note: str


class RateAnswer(Shape):
    """A hazard rate, and all that it is made of."""

    hazard_rate: float | None
    unit: str
    formula: str
    source: str
    inputs: dict[str, str | float]
    """Inputs as they were taken: converted, defaults filled in."""
    factors: list[FactorValue]


@cache
def library() -> Library:
    """Return all models of the handbooks, and how stress can accelerate a constant rate."""
    models = [
        ModelName(name=name, handbook=name.partition(".")[0], title=_title(model), formula=model.formula)
        for name, model in ((name, handbook_model(name)) for name in handbook_models())
    ]
    return Library(models=models, accelerations=[_form(model) for model in ACCELERATIONS.values()])


def form(name: str) -> Form:
    """Return the form of a model. Raises PlugError where there is no such model."""
    return _form(handbook_model(name))


def _title(model: Model) -> str:
    return model.description.partition(":")[0] or model.name.rpartition(".")[2].replace("_", " ")


def _form(model: Model) -> Form:
    return Form(
        name=model.name,
        handbook=model.name.partition(".")[0],
        title=_title(model),
        formula=model.formula,
        source=str(model.source),
        unit=model.unit,
        inputs=[_input(name, entry) for name, entry in model.inputs.items()],
    )


def _input(name: str, entry: Choice | Range | Note) -> FormInput:
    said: dict[str, Any] = {
        "name": name,
        "description": entry.description,
        "required": entry.required,
        "default": entry.default,
    }
    if isinstance(entry, Range):
        low, high = (bound if math.isfinite(bound) else None for bound in (entry.low, entry.high))
        return FormInput(**said, kind="number", unit=entry.unit, low=low, high=high, whole=entry.whole, measurable=True)
    if isinstance(entry, Choice):
        options = list(entry.options)
        meanings: dict[str, str] = {}
        if isinstance(entry.options, Table):
            said["description"] = said["description"] or entry.options.name
            meanings = {option: note for option, note in entry.options.notes.items() if note}
        return FormInput(**said, kind="choice", options=options, meanings=meanings, aliases=dict(entry.aliases))
    return FormInput(**said, kind="words")


def answer(model: str, given: Mapping[str, str | float]) -> RateAnswer:
    """Return the hazard rate for inputs as written. Raises ModelError, UnitError, PlugError."""
    return _answer(handbook_model(model), {name: said for name, said in given.items() if said != ""})


def formula_answer(formula: str, unit: str, variables: Mapping[str, float]) -> RateAnswer:
    """Return the value of a user's own formula. Raises ModelError, UnitError."""
    ranges = {name: Range(-math.inf, math.inf, "", default=value) for name, value in variables.items()}
    return _answer(formula_model(formula, unit, ranges, "own formula"), variables)


def _answer(model: Model, given: Mapping[str, str | float]) -> RateAnswer:
    found = answer_of(model, given)
    factors = [FactorValue(symbol=one.symbol, value=_number(one.value), note=one.note) for one in found.factors]
    return RateAnswer(
        hazard_rate=found.value, unit=model.unit, formula=model.formula, source=str(model.source),
        inputs=dict(found.inputs), factors=factors,
    )  # fmt: skip


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
