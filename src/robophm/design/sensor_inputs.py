"""Assignment of sensors to model inputs: a part's own, those of its module, and how one input follows from another.

A stress that is bound or stated reaches an input by the input's own name, and else as the model declares: all
temperatures in operation follow from ``temperature``. A sensor of a level tells what is around the parts in it; the
part's own temperature (case, junction, lubricant) is then warmer by the rise that it has as designed.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

from robophm.core.errors import PlugError, RobophmError, UnitError
from robophm.core.signal import SECOND, signal_name
from robophm.core.units import conversion, quantity
from robophm.design import schema
from robophm.design.located_error import LocatedError, Path
from robophm.design.robot import Channel, Component, Stress
from robophm.design.task import TaskStress
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import TEMPERATURE, Model, Range

PLAUSIBLE = {"degC": (-100.0, 500.0)}
"""The range of a signal whose binding states none, by the unit of the model input."""

MOST_NAMED = 20
"""The most parts that one warning names."""


class Ambient(NamedTuple):
    """The temperature around the parts of a level as designed [°C], and the place that says so."""

    value: float
    place: Path
    stated: bool
    """Whether the level itself states it; else all parts there state this same temperature."""


class SensorCover(NamedTuple):
    """The sensors of a part's own stresses, and of those around it."""

    signals: Mapping[str, tuple[Path, schema.SignalBinding]]
    own: frozenset[str]
    """Names of those signals that are bound at the part itself."""
    offsets: Mapping[str, str | float]
    ambient: Ambient | None


def channels_of(model: Model, design: Mapping[str, Any], cover: SensorCover) -> dict[str, Channel]:
    """Return the measured inputs of a model at a part. Raises LocatedError where a binding is none of the input."""
    found = {}
    for name, entry in model.numbers.items():
        by = name if name in cover.signals else entry.driver
        if name in design and by in cover.signals and (by == name or _reaches(by, entry, cover)):
            place, binding = cover.signals[by]
            rise = rise_of(design[name], cover.ambient) if _rises(by, entry, cover) else 0.0
            bound = channel(place, binding, entry.unit, by, cover.offsets.get(by), rise)
            found[name] = replace(bound, rise=_above_surroundings(bound, binding, entry, cover))
    return found


def _reaches(by: str, entry: Range, cover: SensorCover) -> bool:
    """Whether a stress reaches an input: a temperature is that of a whole place, a voltage or load only of the part
    itself."""
    binding = cover.signals[by][1]
    if entry.warmth:
        return True
    try:
        conversion(binding.unit or entry.unit, entry.unit)
    except UnitError:  # a load may be a force, a torque or a share
        return False
    return by in cover.own and binding.rated is None


def _above_surroundings(
    bound: Channel, binding: schema.SignalBinding, entry: Range, cover: SensorCover
) -> float | None:
    """How much warmer an input is than the air that its sensor measures [K]; None where it measures no air."""
    level = bound.stress == TEMPERATURE and TEMPERATURE not in cover.own
    if entry.unit != "degC" or not (level or entry.warmth == "ambient"):
        return None
    return bound.shift - (quantity(binding.offset, difference(entry.unit)) if binding.offset is not None else 0.0)


def _rises(by: str, entry: Range, cover: SensorCover) -> bool:
    """Whether the part is warmer than its sensor by the rise as designed, because no offset states by how much."""
    return by == TEMPERATURE and entry.warmth == "own" and by not in cover.own and by not in cover.offsets


def drivers(
    model: Model, design: Mapping[str, Any], channels: Mapping[str, Channel], cover: SensorCover
) -> dict[str, tuple[TaskStress, ...]]:
    """Return, by input, the names by which its stress may be stated, the one that takes precedence first."""
    found = {}
    for name, entry in model.numbers.items():
        if name not in design:
            continue
        names = []
        for by in filter(None, dict.fromkeys((name, entry.driver))):
            if name in channels and channels[name].stress == by:
                shift = channels[name].shift
            else:
                shift = _stated_shift(by, entry.unit, cover)
                shift += rise_of(design[name], cover.ambient) if _rises(by, entry, cover) else 0.0
            names.append(TaskStress(by, shift, bool(entry.warmth) or by == name))
        found[name] = tuple(names)
    return found


def _stated_shift(by: str, unit: str, cover: SensorCover) -> float:
    """The difference of an input from what its sensor reads, as the design and the binding state it."""
    if by not in cover.signals:
        return 0.0
    extras = (cover.signals[by][1].offset, cover.offsets.get(by))
    try:
        return math.fsum(quantity(extra, difference(unit)) for extra in extras if extra is not None)
    except UnitError:  # of another dimension than this input
        return 0.0


def rise_of(own: str | float, ambient: Ambient | None) -> float:
    """Return how much warmer a part is than its surroundings as designed [K]; 0 where that is not known."""
    return float(own) - ambient.value if ambient else 0.0


def difference(unit: str) -> str:
    """Return the unit of a difference of two values."""
    return f"delta_{unit}" if unit in ("degC", "degF") else unit


def channel(
    place: Path, binding: schema.SignalBinding, unit: str, stress: str, more: str | float | None, rise: float
) -> Channel:
    """Build the channel of a bound input in a unit, ``more`` and a ``rise`` above the sensor. Raises LocatedError."""
    try:
        written = unit if binding.unit is None else binding.unit
        if binding.rated is None:
            scale, offset = conversion(written, unit)
        elif unit:
            raise UnitError(f"'rated' is given, but this input is measured in {unit}, not as a share")
        else:
            scale, offset = conversion(written, written).scale / binding.rated, 0.0
        low, high = PLAUSIBLE.get(unit, (-math.inf, math.inf))
        conversion_offset = offset
        if binding.range is not None:
            low, high = sorted(scale * end + offset for end in binding.range)
        shifts = [quantity(extra, difference(unit)) for extra in (binding.offset, more) if extra is not None]
        for shift in (*shifts, rise):
            offset, low, high = offset + shift, low + shift, high + shift
        signal = signal_name(binding.topic, binding.field)
    except RobophmError as error:
        raise LocatedError(place, str(error)) from None
    if binding.range is None and binding.stale == "worst":
        raise LocatedError(place, "stale: worst needs a 'range'; expected e.g. range: [-20, 80]")
    age, shift = round(binding.max_age * SECOND), offset - conversion_offset
    return Channel(signal, written, scale, offset, low, high, age, binding.stale, shift, stress)


def ambient_of(place: Path, level: Any, above: Ambient | None) -> Ambient | None:
    """Return the ambient temperature that a level states or its parts share, else that above. Raises LocatedError."""
    if level.ambient is not None:
        try:
            return Ambient(quantity(level.ambient, "degC"), (*place, "ambient"), stated=True)
        except UnitError as error:
            raise LocatedError((*place, "ambient"), str(error)) from None
    around = set(_around(level))
    return Ambient(around.pop(), place, stated=False) if len(around) == 1 else above


def _around(level: Any) -> Iterator[float]:
    """The ambient temperatures that the parts of a level state [°C]."""
    for module in level.modules.values():
        yield from _around(module)
    for part in level.components.values():
        for mode in (part, *part.failure_modes.values()):
            if mode.hazard is None or mode.hazard.model is None:
                continue
            try:
                numbers = handbook_model(mode.hazard.model).numbers
                yield from (
                    _celsius(mode.hazard.inputs[name])
                    for name, entry in numbers.items()
                    if entry.warmth == "ambient" and name in mode.hazard.inputs
                )
            except (PlugError, UnitError):  # which the part itself will say
                continue


def assumed(parts: Iterable[tuple[Component, SensorCover]]) -> Iterator[tuple[bool, str]]:
    """Yield what is assumed of temperatures that follow from others, with whether the design states what is needed."""
    found: dict[tuple[Path, Ambient | None], dict[str, None]] = {}
    for part, cover in parts:
        for stress in (stress for mode in part.modes for stress in mode.stresses):
            for name, bound in stress.channels.items():
                entry, by = stress.model.numbers[name], bound.stress
                if not _rises(by, entry, cover) or (cover.ambient and (
                    cover.ambient.stated or not rise_of(stress.design[name], cover.ambient)
                )):  # fmt: skip
                    continue
                found.setdefault((cover.signals[by][0], cover.ambient), {})[part.path] = None
    for (place, ambient), paths in found.items():
        if ambient is None:
            said = (
                f"is taken for the own temperature of {named(paths)}: nothing says how warm it is around them as "
                "designed; expected e.g. ambient: 40 degC, above which each keeps its rise"
            )
        else:
            said = (
                f"{named(paths)} {'keeps its' if len(paths) == 1 else 'keep their'} rise above {ambient.value:g} degC, "
                "the ambient temperature as other parts there state it; expected ambient, to say so"
            )
        yield ambient is not None, f"{'/'.join(place)}: {said}"


@lru_cache(maxsize=1024)  # a board's parts all state the same
def _celsius(text: str | float) -> float:
    return quantity(text, "degC")


def undriven(parts: Iterable[tuple[Component, SensorCover]], used: Container[Path]) -> Iterator[str]:
    """Yield, for each sensor, the parts that it covers and yet does not drive, and why."""
    found: dict[Path, dict[str, dict[str, None]]] = {}
    for part, cover in parts:
        places = [place for place, _ in cover.signals.values() if place in used]
        if places and not any(stress.channels for mode in part.modes for stress in mode.stresses):
            nearest = max(places, key=len)
            reasons = dict.fromkeys(_reason(mode.stresses, cover) for mode in part.modes)
            why = "; ".join(reasons)
            found.setdefault(nearest, {}).setdefault(why, {})[part.path] = None
    for place, reasons_of in found.items():
        said = "; ".join(f"{named(paths)} ({why})" for why, paths in reasons_of.items())
        yield f"{'/'.join(place)}: covers parts that no sensor drives: {said}"


def _reason(stresses: tuple[Stress, ...], cover: SensorCover) -> str:
    """The reason why none of the bound stresses reaches a failure mode."""
    bound = " and ".join(cover.signals)
    if not stresses:
        return "a constant rate: an acceleration would make it answer"
    takes = {
        driver.name for stress in stresses for drivers in stress.drivers.values() for driver in drivers
    } & cover.signals.keys()
    if takes - cover.own:
        return f"its {' and '.join(sorted(takes - cover.own))} is its own: to be bound at the part"
    if takes:
        return f"takes its {' and '.join(sorted(takes))} in another unit"
    return f"{' and '.join(stress.model.name for stress in stresses)} takes no {bound}"


def named(paths: Iterable[str]) -> str:
    """Return some paths in words, and how many more there are."""
    listed = list(paths)
    more = f" and {len(listed) - MOST_NAMED} more" if len(listed) > MOST_NAMED else ""
    return ", ".join(listed[:MOST_NAMED]) + more
