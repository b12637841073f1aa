"""NASA's progpy models of batteries and motors: imported when one is asked for, and only then."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from robophm.core.errors import DataError, RobophmError, nearest

Load = Mapping[str, float] | Callable[[float], Mapping[str, float]]
"""Inputs of a model, constant or by time [s]."""


@dataclass(frozen=True)
class Simulated:
    """The result of running a model."""

    times: tuple[float, ...]
    """Times of the outputs [s]."""
    outputs: tuple[dict[str, float], ...]
    event: str
    """The event that ended the run; "" where none did."""


class ProgpyModel:
    """A model of progpy by name, such as BatteryCircuit, BatteryElectroChemEOL or DCMotor."""

    def __init__(self, name: str, **parameters: Any) -> None:
        """Set up the model. Raises RobophmError without progpy, DataError for a model or parameter that it has not."""
        try:
            models = import_module("progpy.models")
        except ImportError as error:
            raise RobophmError(f"this model is progpy's ({error.name or error}). Install robophm[progpy]") from None
        known = [one for one in dir(models) if isinstance(getattr(models, one), type)]
        if name not in known:
            raise DataError(f"progpy has no model '{name}'{nearest(name, known)}")
        self.name, self.model = name, getattr(models, name)()
        for key, value in parameters.items():
            if key not in self.model.parameters:
                raise DataError(f"{name} has no parameter '{key}'{nearest(key, list(self.model.parameters))}")
            self.model.parameters[key] = value

    @property
    def events(self) -> tuple[str, ...]:
        """Return the events that may end its life, e.g. EOD; a motor's model has none, as it models a healthy one."""
        return tuple(self.model.events)

    def run(self, load: Load, until: float, *, step: float = 1.0) -> Simulated:
        """Simulate a load until an event, or a time [s]. Raises DataError for an input that the model has not."""

        def loading(t: float, _: Any = None) -> Any:
            values = load(t) if callable(load) else load
            missing = set(self.model.inputs) - set(values)
            if missing or set(values) - set(self.model.inputs):
                raise DataError(
                    f"{self.name} takes {', '.join(self.model.inputs)}, not {', '.join(values) or 'nothing'}"
                )
            return self.model.InputContainer(dict(values))

        loading(0.0)
        options: dict[str, Any] = {"dt": step, "save_freq": max(until / 1000, step), "horizon": until}
        found = self.model.simulate_to_threshold(loading, **options)
        last = found.states[-1]
        met = [event for event, is_ in self.model.threshold_met(last).items() if is_]
        return Simulated(
            tuple(float(t) for t in found.times),
            tuple({key: float(value) for key, value in dict(one).items()} for one in found.outputs),
            met[0] if met else "",
        )

    def time_to(self, event: str, load: Load, until: float, *, step: float = 1.0) -> float:
        """Seconds until an event under a load; infinite where it does not come by ``until``."""
        if event not in self.events:
            raise DataError(f"{self.name} knows no event '{event}'{nearest(event, self.events)}")
        found = self.run(load, until, step=step)
        return found.times[-1] if found.event == event else math.inf
