"""Types of the values in a design file: a quantity in its unit, a name, a mapping without unknown keys."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    WithJsonSchema,
)

from robophm.core.errors import UnitError
from robophm.core.units import quantity

LONGEST = 1e9
"""Seconds, some thirty years: what a time in a design may be, so that its nanoseconds can be counted."""


class ReadAs:
    """A companion of a type in ``Annotated``: how a written value is read, and the JSON Schema of it."""

    def __init__(self, read: Callable[[object], object], schema: dict[str, Any]) -> None:
        self._before, self._said = BeforeValidator(read), WithJsonSchema(schema)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> Any:
        """Return the schema by which pydantic validates."""
        return self._before.__get_pydantic_core_schema__(source, handler)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> Any:
        """Return what JSON Schema says."""
        return self._said.__get_pydantic_json_schema__(schema, handler)


def quantity_in(
    unit: str, description: str, example: str, low: float = float("-inf"), high: float = float("inf")
) -> ReadAs:
    """Return how a number in ``unit`` is read from a written quantity, to stand beside ``float``."""

    def read(value: object) -> float:
        try:
            number = quantity(value, unit)
        except UnitError as error:
            raise ValueError(str(error)) from None
        if not number >= low:
            raise ValueError(f"{value} is too small; expected at least {low:g} {unit}".rstrip())
        if not number <= high:
            raise ValueError(f"{value} is too large; expected at most {high:g} {unit}".rstrip())
        return number

    kind = {"type": ["string", "number"] if not unit else "string"}
    return ReadAs(read, {**kind, "description": description, "examples": [example]})


def share_in(description: str, example: str, *, zero: bool) -> ReadAs:
    """Return how a share is read from a number, a percentage or hours of a day, to stand beside ``float``: from 0, or
    above it unless ``zero``, to 1."""

    def read(value: object) -> object:
        try:
            return quantity(value, "") if isinstance(value, str) else value
        except UnitError as error:
            raise ValueError(f"{error}; expected a share, e.g. {example}") from None

    low = {"minimum": 0} if zero else {"exclusiveMinimum": 0}
    kinds = [{"type": "number", **low, "maximum": 1}, {"type": "string"}]
    return ReadAs(read, {"anyOf": kinds, "description": description, "examples": [example]})


def _mean_repair(value: object) -> object:
    if value == "none":
        return value
    try:
        hours = quantity(value, "h")
    except UnitError as error:
        raise ValueError(f"{error}; expected a time, e.g. 4 h, or the word none") from None
    if not 0 < hours <= LONGEST / 3600:
        raise ValueError(
            f"{value} is not a time to repair; expected one above 0, of at most 30 years, or the word none"
        )
    return hours


Repair = Annotated[
    float | Literal["none"],
    BeforeValidator(_mean_repair),
    WithJsonSchema({
        "type": "string", "examples": ["4 h", "none"],
        "description": "mean time from a failure until as good as new, waiting included, by the calendar; none: never",
    }),
]  # fmt: skip
"""The mean time [h] that a repair takes, or the word none."""

Name = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^[^/\[\]\x00-\x1f\x7f-\x9f\u2028\u2029]+$")]
"""The name of a module, component, mode or function: any text without / [ ] and control characters."""

Identity = Annotated[
    str,
    Field(
        min_length=1,
        max_length=2000,
        pattern=r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]+$",
        description="path under which the past is kept; default the path here",
    ),
]
"""The path under which a robot's past is kept of something: one that it has had, mostly, or of one of equal parts."""


def _written(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError("expected a quantity with its unit, e.g. '12 FIT', or a word where the input is a choice")
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{value} is not a finite number")
    return value


Written = Annotated[
    str | int | float,
    BeforeValidator(_written),
    WithJsonSchema({"type": ["string", "number"], "description": "a quantity with its unit"}),
]
"""A quantity whose unit depends on its neighbours; it is converted when the robot is put together."""


class Strict(BaseModel):
    """A mapping that says what it has keys for, and nothing else."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True, allow_inf_nan=False)
