"""A mistake at a place in a file, before the file's name and line are known."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from robophm.core.errors import DesignError, UnitError
from robophm.core.units import quantity

Path = tuple[str, ...]
"""Keys from the top of a file down."""


class LocatedError(DesignError):
    """A design error at a place in the file, before the file's name and line are known."""

    def __init__(self, place: Path, message: str) -> None:
        super().__init__(message)
        self.place = place


def error_at(*place: str) -> Callable[[str], LocatedError]:
    """Return a function that makes a fault at a place from its message."""
    return partial(LocatedError, place)


@contextmanager
def errors_below(place: Path) -> Iterator[None]:
    """Prefix this place to that of any fault raised inside."""
    try:
        yield
    except LocatedError as fault:
        raise LocatedError((*place, *fault.place), str(fault)) from None


def quantity_at(place: Path, value: object, unit: str) -> float:
    """Return a quantity that a file states, in a unit. Raises LocatedError where it is none, or not finite."""
    try:
        number = quantity(value, unit)
    except UnitError as error:
        raise LocatedError(place, str(error)) from None
    if not math.isfinite(number):
        raise LocatedError(place, f"{value} is not a finite number")
    return number
