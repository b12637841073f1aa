"""A robot's design as the simulator sees it: its modes of failure, what stresses them, and how its parts make it up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.simulation.lives import Life
from robophm.simulation.structure import Block

Array = npt.NDArray[np.float64]

CLOCKS: Mapping[str, str] = {
    "operating": "h",
    "calendar": "h",
    "kilometres": "km",
    "cycles": "cycle",
    "starts": "start",
}
"""Clocks that parts age on, and the unit of each."""

INPUTS: Mapping[str, str] = {"temperature": "degC", "load": "", "voltage": "V"}
"""Inputs that can be measured, and the unit of each."""

BOLTZMANN = 8.617333e-5
"""Boltzmann's constant [eV/K]."""


@dataclass(frozen=True)
class Stress:
    """One acceleration of a mode by one signal."""

    model: str
    parameters: tuple[float, ...]
    signal: int
    shift: float
    """Added to what the sensor reads."""

    def factor(self, reading: Array) -> Array:
        """AF at what the sensor reads; 1 at the reference."""
        x = reading + self.shift
        first, reference = self.parameters
        result: Array
        if self.model == "q10":
            result = first ** ((x - reference) / 10)
        elif self.model == "arrhenius":
            result = np.exp(first / BOLTZMANN * (1 / (reference + 273.15) - 1 / (x + 273.15)))
        else:  # cubic_load, inverse_power
            result = np.abs(x / reference) ** first
        return result


@dataclass(frozen=True)
class Signal:
    """A number that a sensor reads: the truth, without noise."""

    name: str
    input: str
    scale: float
    """The model input is scale · message + offset."""
    offset: float
    low: float
    high: float
    """Highest reading, in the unit of the model input; ``low`` is the lowest."""
    keys: tuple[str, ...]
    """Keys by which a task file states it: ``temperature``, ``Power/temperature``."""
    reference: float | None = None
    """Reference of the first acceleration that it drives."""


@dataclass(frozen=True)
class Mode:
    """A failure mode of a part."""

    part: int
    name: str
    """Name of it below its part; empty where the part states a single one without a name."""
    rate: float
    """Hazard rate at reference stress [1/clock]."""
    life: Life
    clock: str
    by_hazard: bool
    """Stress scales the hazard, not the age."""
    initial: float
    duty: float
    stresses: tuple[Stress, ...]
    origin: str
    """Key of its true rate, of which modes with the same share one draw: its path in the component, or its entry."""
    uncertainty: tuple[str, tuple[float, ...]] | None


@dataclass(frozen=True)
class Design:
    """A robot's design as the simulator reads it."""

    name: str
    parts: tuple[str, ...]
    modes: tuple[Mode, ...]
    """Modes in the order of their parts; every part has one at least."""
    whole: Block
    functions: Mapping[str, Block]
    signals: tuple[Signal, ...]
    speed: tuple[tuple[str, float], ...]
    """Signals that say the robot's speed, and the unit of each in m/s."""
    powered: str
    usage: Mapping[str, float]
    """``operating`` share of the time; cycles and starts per operating hour."""
    max_age: float
    """Time after which each sensor must have spoken again [s]."""
