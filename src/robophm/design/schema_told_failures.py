"""How a design states which failures the robot's software tells of."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from robophm.design.schema_fields import LONGEST, Strict, quantity_in

MOST_TELLERS = 20
"""Signals that tell of failures of one failure mode, at most."""

_Node = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*$")]
_Values = Annotated[list[float], Field(min_length=1, max_length=100)]

_Silence = Annotated[
    float, quantity_in("s", "in place of values: so long a silence of it is a failure", "10 s", 1.0, LONGEST)
]


class ToldFailure(Strict):
    """A failure that software tells of: a node by its log or its lifecycle, any signal by its value or its silence."""

    log: _Node | None = Field(None, description="a node whose messages on /rosout tell, e.g. /lidar_driver")
    level: Literal["error", "fatal"] = Field("error", description="of such a message, at least")
    words: str | None = Field(
        None, min_length=1, max_length=200, pattern=r"^[^\[\]\x00-\x1f\x7f]+$",
        description="that such a message has, in large or small letters; default: any",
    )  # fmt: skip
    lifecycle: _Node | None = Field(
        None, description="a managed node of ROS 2: ErrorProcessing is a failure, Active that it works again"
    )
    topic: str | None = Field(None, min_length=1, description="of any other signal, e.g. /lidar/status")
    field: str | None = Field(None, min_length=1, description="path of the number in its message")
    values: _Values | None = Field(None, description="of that signal, that are a failure")
    silent: _Silence | None = None
    works: _Values | None = Field(None, description="of that signal, that say that the part works again")

    @model_validator(mode="after")
    def _one_kind(self) -> ToldFailure:
        if sum(kind is not None for kind in (self.log, self.lifecycle, self.topic)) != 1:
            raise ValueError("expected exactly one of log, lifecycle, topic")
        if self.log is None and {"level", "words"} & self.model_fields_set:
            raise ValueError("level and words are of messages on /rosout; expected log: NODE")
        if self.topic is None and {"field", "values", "works", "silent"} & self.model_fields_set:
            raise ValueError("field, values, works and silent are of any other signal; expected a topic with them")
        if self.topic is not None and (self.field is None or (self.values is None) == (self.silent is None)):
            raise ValueError(
                "a topic tells by a field; expected field, and values or silent, e.g. field: fault, values: [1]"
            )
        if self.silent is not None and self.works is not None:
            raise ValueError("what was silent works again once it is heard; expected no works")
        if {*(self.values or ())} & {*(self.works or ())}:
            raise ValueError("a value says that it failed and that it works; expected one of both")
        return self


ToldFailures = Annotated[list[ToldFailure], Field(min_length=1, max_length=MOST_TELLERS)]
"""The signals that tell of failures of one failure mode."""
