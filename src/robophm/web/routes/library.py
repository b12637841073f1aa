"""The hazard models: forms, and their answers with every factor."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any

from fastapi import APIRouter, Path

from robophm.web.access.roles import needs
from robophm.web.model_forms import (
    Form,
    FormulaAsked,
    Library,
    RateAnswer,
    RateAsked,
    answer,
    form,
    formula_answer,
    library,
)
from robophm.web.routes.design import REFUSED

router = APIRouter(prefix="/api/library", tags=["library"])


@router.get("")
def get_library() -> Library:
    """All models by name, and how stress can accelerate a constant rate."""
    return library()


@router.get("/models/{name}", responses=REFUSED)
def get_model(name: Annotated[str, Path(max_length=200)]) -> Form:
    """The form of a model: its inputs, units and choices."""
    return form(name)


@router.post("/rate", responses=REFUSED)
@needs("viewer")
def rate(asked: RateAsked) -> RateAnswer:
    """The hazard rate for inputs as a person writes them, with every factor."""
    return answer(asked.model, asked.inputs)


@router.post("/formula", responses=REFUSED)
@needs("viewer")
def formula(asked: FormulaAsked) -> RateAnswer:
    """The value of a formula of one's own."""
    return formula_answer(asked.formula, asked.unit, asked.variables)


@router.get("/schema")
def get_schema() -> dict[str, Any]:
    """The JSON Schema of a design file."""
    return _schema()


@cache
def _schema() -> dict[str, Any]:
    from robophm.design.schema import json_schema

    return json_schema()
