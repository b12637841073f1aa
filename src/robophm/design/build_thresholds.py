"""Construction of the limits of health, and of signals, from a design."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from robophm.core.errors import nearest
from robophm.core.signal import SECOND
from robophm.design import schema_thresholds as schema
from robophm.design.located_error import LocatedError, Path, quantity_at
from robophm.design.thresholds import Level, Limits, SignalLimits, Thresholds

_AT_MOST = ("hazard_rate", "above")
"""The limits that a value must not exceed; the others it must not fall below."""

_FIGURES = ("hazard_rate", "reliability", "remaining_life", "completion")


def build_thresholds(
    place: Path,
    stated: schema.PartThresholds | schema.ModuleThresholds | schema.Thresholds,
    units: Mapping[str, str] | None = None,
) -> Thresholds:
    """Return the limits of a part, a module or the robot. Raises LocatedError where one contradicts itself.

    ``units``: the units of the signals that may be limited, by their names.
    """
    return Thresholds(
        **_limits(place, stated, units or {}),
        warning=Limits(**_limits((*place, "warning"), stated.warning, units or {})),
        survival=getattr(stated, "survival", None),
    )


def _limits(place: Path, stated: schema.PartLimits, units: Mapping[str, str]) -> dict[str, Any]:
    figures: dict[str, Any] = {
        name: _level((*place, name), level, level.limit, level.clear)
        for name in _FIGURES
        if (level := getattr(stated, name, None)) is not None
    }
    signals = {
        name: _of_signal((*place, "signals", name), name, limits, units)
        for name, limits in getattr(stated, "signals", {}).items()
    }
    return figures | {"signals": signals}


def _of_signal(place: Path, name: str, limits: schema.SignalLimits, units: Mapping[str, str]) -> SignalLimits:
    if name not in units:
        raise LocatedError(place, f"no signal '{name}' is bound to a stress of a part{nearest(name, units)}")

    def level(side: str) -> Level | None:
        stated = getattr(limits, side)
        if stated is None:
            return None
        at = (*place, side)
        limit = quantity_at((*at, "limit"), stated.limit, units[name])
        clear = None if stated.clear is None else quantity_at((*at, "clear"), stated.clear, units[name])
        return _level(at, stated, limit, clear)

    if limits.above is None and limits.below is None:
        raise LocatedError(place, "has no limit; expected above, below or both")
    return SignalLimits(level("above"), level("below"))


def _level(place: Path, stated: schema._Level, limit: float, clear: float | None) -> Level:
    if clear is not None and (clear > limit if place[-1] in _AT_MOST else clear < limit):
        side = "above" if place[-1] in _AT_MOST else "below"
        raise LocatedError(
            (*place, "clear"), f"{clear:g} is {side} the limit {limit:g}; expected the side on which all is well"
        )
    return Level(limit, limit if clear is None else clear, round(stated.delay * SECOND))
