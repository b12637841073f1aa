"""Construction of the signal that shows a part's wear, with its threshold, from a design."""

from __future__ import annotations

import math

from robophm.core.errors import RobophmError, UnitError
from robophm.core.signal import SECOND, signal_name
from robophm.core.units import conversion
from robophm.design import schema
from robophm.design.located_error import LocatedError, Path, quantity_at
from robophm.design.wear_signal import Gauge, WearSignal


def build_wear(place: Path, said: schema.Wear, quantity: int) -> WearSignal:
    """Build the wear signal of one part. Raises LocatedError if ``quantity`` exceeds one or it contradicts itself."""
    if quantity > 1:
        raise LocatedError(
            place, f"one signal shows the wear of one part, not of {quantity}; expected components of their own"
        )
    unit = said.unit
    if unit is not None:
        try:
            conversion(unit, unit)
        except UnitError as error:
            raise LocatedError((*place, "unit"), str(error)) from None
    in_reading = unit or ""
    if said.reading == "kurtosis":
        in_reading = ""
    elif unit in ("degC", "degF") and (said.ambient or said.reading == "rms"):
        in_reading = f"delta_{unit}"
    deviation = 0.0
    if said.threshold_deviation is not None:
        difference = f"delta_{unit}" if in_reading in ("degC", "degF") else in_reading
        deviation = quantity_at((*place, "threshold_deviation"), said.threshold_deviation, difference)
    if deviation < 0:
        raise LocatedError(
            (*place, "threshold_deviation"), f"{said.threshold_deviation} is negative; expected at least 0"
        )
    return WearSignal(
        _gauge(place, said.topic, said.field, said.range, 0.0),
        unit,
        said.reading,
        round(said.every * SECOND),
        _beside((*place, "ambient"), said.ambient),
        _beside((*place, "load"), said.load),
        quantity_at((*place, "threshold"), said.threshold, in_reading),
        deviation,
        said.share,
        said.teachers,
    )


def _beside(place: Path, said: schema.WearGauge | None) -> Gauge | None:
    return _gauge(place, said.topic, said.field, said.range, said.max_age) if said else None


def _gauge(place: Path, topic: str, field: str, limits: tuple[float, float] | None, max_age: float) -> Gauge:
    try:
        return Gauge(signal_name(topic, field), *(limits or (-math.inf, math.inf)), round(max_age * SECOND))
    except RobophmError as error:
        raise LocatedError(place, str(error)) from None
