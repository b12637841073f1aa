"""Construction of a life distribution from a stated rate or age and the distribution's shape."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any, TypeVar

from robophm.core.errors import ModelError, PlugError, UnitError, nearest
from robophm.core.units import quantity
from robophm.design import schema
from robophm.design.located_error import LocatedError, Path, quantity_at
from robophm.life import life_distribution
from robophm.life.distribution import LifeDistribution
from robophm.parts import FIGURES

MEANS = ("mtbf", "mttf")
"""Keys that state the mean life."""

TENTHS = ("l10", "b10")
"""Keys that state the age by which a tenth have failed."""

ABOVE_ZERO = "expected above zero: a part that never fails is no part"

_Plug = TypeVar("_Plug")


def key_of_figure(place: Path, mode: schema.FailureMode) -> str | None:
    """Return the key that states a mode's frequency; None where only its life can. Raises LocatedError where two do."""
    stated = [key for key in (*FIGURES, "hazard") if getattr(mode, key) is not None]
    if len(stated) > 1:
        raise LocatedError(
            (*place, stated[0]), f"both '{stated[0]}' and '{stated[1]}' are given; expected one of the two"
        )
    return stated[0] if stated else None


def figure_of(place: Path, mode: schema.FailureMode, key: str, unit: str) -> float:
    """Return the rate [1/clock] or age [clock] that a key states. Raises LocatedError if that is not above zero."""
    at, said = (*place, key), getattr(mode, key)
    if key != "rate":
        try:
            age = quantity_at(at, said, unit)
        except LocatedError as fault:
            clock = "operating hours" if mode.clock == "operating" else f"the clock '{mode.clock}'"
            raise LocatedError(at, f"{fault}: {key} is an age in {unit} of {clock}") from None
        if not age > 0:
            raise LocatedError(at, f"{key} {said}; expected above zero")
        return age
    try:
        rate = quantity_at(at, said, f"1/{unit}")
    except LocatedError as fault:
        raise LocatedError(at, f"{fault}{_if_age(said, unit)}") from None
    if not rate > 0:
        raise LocatedError(at, f"hazard rate {said}; {ABOVE_ZERO}")
    return rate


def _if_age(said: object, unit: str) -> str:
    """A hint to the user, where a rate is really a time between failures."""
    try:
        quantity(said, unit)
    except UnitError:
        return ""
    return f"; an MTBF? write mtbf: {said}"


def build_life(
    place: Path, life: schema.Life, figure: tuple[str, float] | None, unit: str, factor: float
) -> tuple[LifeDistribution, float]:
    """Return the life of a mode and its rate [1/clock], ``factor`` times what is stated. Raises LocatedError.

    ``figure``: how often it comes by the key that says so; None where the life has its own scale. A mean life and a
    tenth are turned into a rate here, and nowhere else: through the distribution itself.
    """
    at = (*place, "life")
    kind: type[LifeDistribution] = plug((*at, "distribution"), life_distribution, life.distribution)
    parameters = _parameters(at, life, kind, unit)
    key, number = figure or ("", math.nan)
    if not key and not parameters:
        expected = "rate, mtbf, l10, hazard, part, failure_modes, or a life with its scale"
        raise LocatedError(place, f"has no rate; expected {expected}")
    if key and kind.scale_parameter in parameters:
        said = f"'{key}'" if key in MEANS + TENTHS else "a rate"
        raise LocatedError(
            (*at, str(kind.scale_parameter)),
            f"{said} and the life's own {kind.scale_parameter} are given; expected one of the two",
        )
    try:
        if key in MEANS:
            found = kind.with_mean(number, **parameters)
        elif key in TENTHS:
            found = kind.with_quantile(0.1, number, **parameters)
        elif key:
            return _of_rate(kind, number * factor, parameters), number * factor
        else:
            found = kind(**parameters)
        rate = found.nominal_rate
        if not 0 < rate < math.inf:
            raise ModelError(f"{kind.__name__}: its mean is {found.mean():g}, expected a finite number > 0")
        if factor == 1:
            return found, rate
        if kind.scale_parameter is None:
            return found.rescaled(1 / factor), rate * factor
        parameters.pop(kind.scale_parameter, None)
        return kind.with_rate(rate * factor, **parameters), rate * factor
    except (ModelError, TypeError) as error:
        raise LocatedError(at, str(error)) from None


def _of_rate(kind: type[LifeDistribution], rate: float, parameters: Mapping[str, Any]) -> LifeDistribution:
    """A life of this rate, of equal parts the same one: a large design has few kinds of parts."""
    if any(isinstance(value, list | dict) for value in parameters.values()):
        return kind.with_rate(rate, **parameters)
    return _kept_of_rate(kind, rate, *parameters.items())


@lru_cache(maxsize=4096)
def _kept_of_rate(kind: type[LifeDistribution], rate: float, *parameters: tuple[str, float]) -> LifeDistribution:
    return kind.with_rate(rate, **dict(parameters))


def _parameters(place: Path, life: schema.Life, kind: type[LifeDistribution], unit: str) -> dict[str, Any]:
    parameters: dict[str, Any] = {}
    for name, value in (life.model_extra or {}).items():
        if name not in kind.dimensions:
            raise LocatedError(
                (*place, name), f"{life.distribution} has no parameter '{name}'{nearest(name, kind.dimensions)}"
            )
        inside = {1: unit, 0: "", -1: f"1/{unit}"}[kind.dimensions[name]]
        parameters[name] = _quantities((*place, name), value, inside)
    return parameters


def _quantities(place: Path, value: Any, unit: str) -> Any:
    """A quantity, or those in lists and mappings, as numbers of the unit. Raises LocatedError."""
    if isinstance(value, list):
        return [quantity_at(place, one, unit) for one in value]
    if isinstance(value, dict):
        return {key: _quantities((*place, str(key)), one, unit) for key, one in value.items()}
    return quantity_at(place, value, unit)


def plug(place: Path, find: Callable[[str], _Plug], name: str) -> _Plug:
    """Return the life, model or acceleration that a design names. Raises LocatedError where there is none."""
    try:
        return find(name)
    except PlugError as error:
        raise LocatedError(place, str(error)) from None
