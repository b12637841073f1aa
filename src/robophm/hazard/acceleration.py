"""How stress shortens life: factors of the hazard rate that are 1 at the reference stress.

The Arrhenius law here is the physical one (273.15 K, k = 8.617333e-5 eV/K); the handbooks' rounded one is in
``handbooks`` and never mixes with it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from robophm.core.errors import PlugError, nearest
from robophm.core.table import Source
from robophm.hazard.model import Array, Factor, Model, Range, acceleration

BOLTZMANN = 8.617333e-5
"""eV/K."""

ABSOLUTE_ZERO = -273.15
"""°C."""

_TEMPERATURE = Range(-100.0, 500.0, "degC", "temperature of the part", monotone=1)
_REFERENCE = Range(-100.0, 500.0, "degC", "temperature at which the stated rate holds", default=25.0)


@acceleration(
    source=Source("NIST/SEMATECH e-Handbook", "8.1.5.1", "Arrhenius", "closed form"),
    inputs={
        "temperature": _TEMPERATURE,
        "reference_temperature": _REFERENCE,
        "activation_energy": Range(0.0, 5.0, "eV", "activation energy of the failure mechanism"),
    },
)
def arrhenius(temperature: Array, reference_temperature: Array, activation_energy: Array) -> Factor:
    """AF = exp(Ea/k · (1/T₀ − 1/T)), T in kelvin.

    What a broken sensor says below 1 K counts as 1 K: beyond the pole at 0 K the formula would be infinite.
    """
    cold = 1 / (np.asarray(reference_temperature) - ABSOLUTE_ZERO)
    hot = 1 / np.maximum(np.asarray(temperature) - ABSOLUTE_ZERO, 1.0)
    return Factor("AF", np.exp(activation_energy / BOLTZMANN * (cold - hot)), "Arrhenius")


@acceleration(
    source=Source("PHM tool for ROS (2020)", "ALT", "temperature model", "closed form"),
    inputs={
        "temperature": _TEMPERATURE,
        "reference_temperature": _REFERENCE,
        "q": Range(1.0, 10.0, "", "factor for every 10 K", default=2.0),
    },
)
def q10(temperature: Array, reference_temperature: Array, q: Array) -> Factor:
    """AF = q^((T − T₀)/10)."""
    exponent = (np.asarray(temperature) - np.asarray(reference_temperature)) / 10
    return Factor("AF", np.power(q, exponent), "Q10 rule")


ACCELERATIONS: Mapping[str, Model] = {"arrhenius": arrhenius, "q10": q10}
"""Every acceleration by its name in a design."""


def acceleration_model(name: str) -> Model:
    """The acceleration of that name. Raises PlugError with the nearest known name."""
    if name not in ACCELERATIONS:
        raise PlugError(f"no acceleration '{name}'{nearest(name, ACCELERATIONS)}")
    return ACCELERATIONS[name]
