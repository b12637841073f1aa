"""The schema of tasks, and of what is known before them, in a design file or a list of tasks."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, field_validator

from robophm.design.schema_fields import Name, Strict, Written, quantity_in


class Leg(Strict):
    """A part of a task: two of distance, speed and duration, or a duration alone."""

    distance: Annotated[float, quantity_in("m", "to drive", "250 m", 0.0)] | None = None
    speed: Annotated[float, quantity_in("m/s", "while driving", "0.3 m/s", 0.0)] | None = None
    duration: (
        Annotated[float, quantity_in("h", "instead of distance and speed, or with a distance", "20 min", 0.0)] | None
    ) = None
    cycles: Annotated[float, Field(ge=0, description="in this leg; default by the usage per hour")] | None = None
    starts: Annotated[float, Field(ge=0, description="in this leg; default by the usage per hour")] | None = None
    functions: list[Name] = Field(default_factory=list, description="what must work; default the whole robot")
    stresses: dict[str, Written] = Field(
        default_factory=dict, description="what sensors would read: temperature, or Power/temperature below a module"
    )

    @field_validator("cycles", "starts", mode="before")
    @classmethod
    def _counted(cls, value: object) -> object:
        if isinstance(value, bool):
            raise ValueError(f"expected a number, not {value}")
        return value


class Task(Strict):
    """One job of the robot, leg after leg."""

    name: Annotated[str, Field(max_length=200, pattern=r"^[^\x00-\x09\x0b-\x1f\x7f-\x9f]*$")] = ""
    legs: list[Leg] = Field(min_length=1, max_length=10_000)


def _kind_of_task(value: object) -> str:
    return "Task" if isinstance(value, Task) or (isinstance(value, dict) and "legs" in value) else "Leg"


AnyTask = Annotated[Annotated[Task, Tag("Task")] | Annotated[Leg, Tag("Leg")], Discriminator(_kind_of_task)]
"""A task, or its only leg."""


class Knowledge(Strict):
    """Knowledge of parts, by their paths."""

    failed: list[str] = Field(default_factory=list, description="have failed")
    working: list[str] = Field(default_factory=list, description="work now")


class TaskFile(Strict):
    """Tasks in their order, and what is known before the first."""

    schema_version: Literal[1]
    tasks: list[AnyTask] = Field(min_length=1, max_length=100_000)
    knowledge: Knowledge = Field(default_factory=Knowledge)
    every: Annotated[float, quantity_in("h", "the list is begun anew so often", "8 h", 0.0)] | None = None
