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
"""Boltzmann's constant [eV/K]."""

ABSOLUTE_ZERO = -273.15
"""Absolute zero in degrees Celsius [°C]."""

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
    return Factor("AF", _arrhenius(temperature, reference_temperature, activation_energy), "Arrhenius")


def _arrhenius(temperature: Array, reference: Array, activation_energy: Array) -> Array:
    result: Array = np.exp(activation_energy / BOLTZMANN * (1 / _kelvin(reference) - 1 / _kelvin(temperature)))
    return result


def _kelvin(celsius: Array) -> Array:
    return np.maximum(np.asarray(celsius) - ABSOLUTE_ZERO, 1.0)


@acceleration(
    source=Source(
        "NIST/SEMATECH e-Handbook",
        "8.1.5.2",
        "Eyring: t = A·T^α·exp(ΔH/kT), here n = −α",
        "closed form; n = 1 as Eyring has it",
    ),
    inputs={
        "temperature": _TEMPERATURE,
        "reference_temperature": _REFERENCE,
        "activation_energy": Range(0.0, 5.0, "eV", "activation energy of the failure mechanism"),
        "exponent": Range(0.0, 5.0, "", "n, of the kelvins before the exponential", default=1.0),
    },
)
def eyring(temperature: Array, reference_temperature: Array, activation_energy: Array, exponent: Array) -> Factor:
    """AF = (T/T₀)ⁿ · exp(Ea/k · (1/T₀ − 1/T)), T in kelvin, of temperature alone.

    What a broken sensor says below 1 K counts as 1 K, as for Arrhenius.
    """
    share = np.power(_kelvin(temperature) / _kelvin(reference_temperature), exponent)
    return Factor("(T/T₀)ⁿ", share, "Eyring") * Factor(
        "exp", _arrhenius(temperature, reference_temperature, activation_energy), "Arrhenius"
    )


@acceleration(
    source=Source(
        "D. S. Peck, Comprehensive model for humidity testing correlation, IEEE IRPS 1986",
        "–",
        "–",
        "closed form; exponent 2.66 and 0.79 eV are Peck's, of epoxy packages (from memory)",
    ),
    inputs={
        "humidity": Range(0.0, 100.0, "percent", "relative humidity at the part", monotone=1),
        "reference_humidity": Range(1.0, 100.0, "percent", "humidity at which the stated rate holds"),
        "temperature": _TEMPERATURE,
        "reference_temperature": _REFERENCE,
        "exponent": Range(0.0, 10.0, "", "n, of humidity", default=2.66),
        "activation_energy": Range(0.0, 5.0, "eV", "activation energy of the failure mechanism", default=0.79),
    },
)
def peck(
    humidity: Array,
    reference_humidity: Array,
    temperature: Array,
    reference_temperature: Array,
    exponent: Array,
    activation_energy: Array,
) -> Factor:
    """AF = (RH/RH₀)ⁿ · exp(Ea/k · (1/T₀ − 1/T)), T in kelvin.

    A humidity below zero, which only a broken sensor says, counts as dry air.
    """
    share = np.power(np.maximum(humidity, 0.0) / np.asarray(reference_humidity), exponent)
    return Factor("(RH/RH₀)ⁿ", share, "Peck") * Factor(
        "exp", _arrhenius(temperature, reference_temperature, activation_energy), "Arrhenius"
    )


@acceleration(
    source=Source("NIST/SEMATECH e-Handbook", "8.1.5.2", "Coffin–Manson", "closed form"),
    inputs={
        "temperature_swing": Range(0.0, 1000.0, "K", "from the coldest to the hottest of a cycle", monotone=1),
        "reference_temperature_swing": Range(1e-3, 1000.0, "K", "swing at which the stated rate per cycle holds"),
        "exponent": Range(0.0, 20.0, "", "m: about 2 for solder, 4 for hard alloys, 6 and more for brittle materials"),
    },
)
def coffin_manson(temperature_swing: Array, reference_temperature_swing: Array, exponent: Array) -> Factor:
    """AF = (ΔT/ΔT₀)ᵐ on the clock of cycles or starts; a swing and its opposite count alike."""
    share = np.abs(np.asarray(temperature_swing)) / np.asarray(reference_temperature_swing)
    return Factor("AF", np.power(share, exponent), "Coffin–Manson")


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
    return Factor("AF", np.exp(np.log(q) * exponent), "Q10 rule")  # power() takes three times as long


@acceleration(
    source=Source("PHM tool for ROS (2020)", "ALT", "load model", "closed form"),
    inputs={
        "load": Range(-100.0, 100.0, "", "load as a share of the rated one"),
        "reference_load": Range(1e-6, 100.0, "", "load at which the stated rate holds", default=1.0),
    },
)
def cubic_load(load: Array, reference_load: Array) -> Factor:
    """AF = (P/P₀)³, as of rolling bearings and gears; a load and its opposite count alike."""
    share = np.abs(np.asarray(load)) / np.asarray(reference_load)
    return Factor("AF", share**3, "cubic load law")


@acceleration(
    source=Source("NIST/SEMATECH e-Handbook", "8.1.5.2", "inverse power law", "closed form"),
    inputs={
        "voltage": Range(-1e6, 1e6, "V", "voltage across the part"),
        "reference_voltage": Range(1e-6, 1e6, "V", "voltage at which the stated rate holds"),
        "exponent": Range(0.0, 30.0, "", "of the failure mechanism"),
    },
)
def inverse_power(voltage: Array, reference_voltage: Array, exponent: Array) -> Factor:
    """AF = (V/V₀)ⁿ; a voltage and its opposite count alike."""
    share = np.abs(np.asarray(voltage)) / np.asarray(reference_voltage)
    return Factor("AF", np.power(share, exponent), "inverse power law")


ACCELERATIONS: Mapping[str, Model] = {
    model.name: model for model in (arrhenius, eyring, q10, peck, coffin_manson, cubic_load, inverse_power)
}
"""Every acceleration by its name in a design."""

PER_CYCLE = frozenset({"coffin_manson"})
"""Accelerations of damage that comes with every cycle or start, whatever the time between."""


def stress_inputs(model: Model) -> tuple[str, ...]:
    """The inputs of an acceleration that are measured: those that have a reference."""
    return tuple(name for name in model.inputs if f"reference_{name}" in model.inputs)


def acceleration_model(name: str) -> Model:
    """The acceleration of that name. Raises PlugError with the nearest known name."""
    if name not in ACCELERATIONS:
        raise PlugError(f"no acceleration '{name}'{nearest(name, ACCELERATIONS)}")
    return ACCELERATIONS[name]
