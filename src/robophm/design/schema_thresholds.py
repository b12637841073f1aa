"""How a design states its limits of health, and of signals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, model_validator

from robophm.design.schema_fields import LONGEST, Strict, Written, quantity_in


def _or_limit_alone(schema: dict[str, Any]) -> None:
    whole = dict(schema)
    schema.clear()
    schema["anyOf"] = [whole, whole["properties"]["limit"]]


class _Level(Strict):
    """A limit, and what an alarm on it waits for. A value alone is the limit."""

    model_config = ConfigDict(json_schema_extra=_or_limit_alone)

    delay: Annotated[
        float, quantity_in("s", "how long it must last before there is an alarm", "10 s", 0.0, LONGEST)
    ] = 0.0

    @model_validator(mode="before")
    @classmethod
    def _limit_alone(cls, said: object) -> object:
        return said if isinstance(said, dict) else {"limit": said}


class RateLevel(_Level):
    """A hazard rate that is too high."""

    limit: Annotated[float, quantity_in("1/h", "at most", "1000 FPMH", 0.0)]
    clear: Annotated[float, quantity_in("1/h", "at which an alarm ends; default the limit", "900 FPMH", 0.0)] | None = (
        None
    )


class ShareLevel(_Level):
    """A probability that is too low."""

    limit: Annotated[float, Field(gt=0, lt=1, description="at least")]
    clear: Annotated[float, Field(gt=0, le=1, description="at which an alarm ends; default the limit")] | None = None


class LifeLevel(_Level):
    """A remaining life that is too short."""

    limit: Annotated[float, quantity_in("h", "median, at least", "500 h", 0.0)]
    clear: Annotated[float, quantity_in("h", "at which an alarm ends; default the limit", "600 h", 0.0)] | None = None


class SignalLevel(_Level):
    """A value of a signal, in its unit, that is too high or too low."""

    limit: Written = Field(description="in the unit that the signal is bound with, e.g. 80 degC")
    clear: Written | None = Field(default=None, description="at which an alarm ends; default the limit")


class SignalLimits(Strict):
    """Limits of what a signal may say."""

    above: SignalLevel | None = Field(default=None, description="too high from here on")
    below: SignalLevel | None = Field(default=None, description="too low from here on")


class PartLimits(Strict):
    """How good a part's health must be, as sensors have it."""

    hazard_rate: RateLevel | None = None
    reliability: ShareLevel | None = Field(default=None, description="since new")
    remaining_life: LifeLevel | None = None


class Limits(PartLimits):
    """How good health must be, as sensors have it."""

    completion: ShareLevel | None = Field(default=None, description="of the task")


class RobotLimits(Limits):
    """How good the robot's health must be, and what its signals may say."""

    signals: dict[str, SignalLimits] = Field(default_factory=dict, description="by their names, e.g. /motor.current")


class PartThresholds(PartLimits):
    """Limits beyond which a part's health is no longer good enough: an error, and before it a warning."""

    warning: PartLimits = Field(default_factory=PartLimits, description="the same, where attention is due")


class ModuleThresholds(Limits):
    """Limits beyond which a module's health is no longer good enough: an error, and before it a warning."""

    warning: Limits = Field(default_factory=Limits, description="the same, where attention is due")


class Thresholds(RobotLimits):
    """Limits beyond which the robot's health is no longer good enough (exit code 1)."""

    warning: RobotLimits = Field(default_factory=RobotLimits, description="the same, where attention is due")
    survival: Annotated[float, Field(gt=0, lt=1, description="state also when survival ahead falls to this")] | None = (
        None
    )


def threshold_model(place: Sequence[str], of_what: str) -> type[BaseModel]:
    """Return the model of the mapping at a place within thresholds: of modules, of components, else of the robot."""
    inner = place[1:] if place[:1] == ("warning",) else place
    match inner:
        case []:
            models: dict[str, list[type[BaseModel]]] = {
                "modules": [ModuleThresholds, Limits],
                "components": [PartThresholds, PartLimits],
            }
            return models.get(of_what, [Thresholds, RobotLimits])[len(place)]
        case ["signals", _]:
            return SignalLimits
        case ["signals", _, _]:
            return SignalLevel
        case [figure, *_]:
            levels: dict[str, type[BaseModel]] = {"hazard_rate": RateLevel, "remaining_life": LifeLevel}
            return levels.get(figure, ShareLevel)
    return Thresholds
