"""What is wrong at a place in a file, before the file's name and line are known."""

from __future__ import annotations

import math

from robophm.core.errors import DesignError, UnitError
from robophm.core.units import quantity

Path = tuple[str, ...]
"""Keys from the top of a file down."""


class Fault(DesignError):  # noqa: N818  what geologists and engineers call it
    """A design error at a place in the file, before the file's name and line are known."""

    def __init__(self, place: Path, message: str) -> None:
        super().__init__(message)
        self.place = place


def written(place: Path, value: object, unit: str) -> float:
    """A quantity as the file says it, in a unit. Raises Fault where it is none, or not finite."""
    try:
        number = quantity(value, unit)
    except UnitError as error:
        raise Fault(place, str(error)) from None
    if not math.isfinite(number):
        raise Fault(place, f"{value} is not a finite number")
    return number
