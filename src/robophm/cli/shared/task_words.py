"""Values of the options about tasks."""

from __future__ import annotations

from robophm.core.errors import UnitError
from robophm.core.units import quantity


def stated_speed(text: str | None) -> float | None:
    """Return the speed that ``--speed`` states [m/s]. Raises UnitError where it is none."""
    speed = quantity(text, "m/s") if text is not None else None
    if speed is not None and not speed > 0:
        raise UnitError(f"--speed {text}: expected above zero")
    return speed
