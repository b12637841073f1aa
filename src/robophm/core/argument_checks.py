"""Checks of arguments from the Python interface, as strict as of files: one line says what was expected."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from robophm.core.errors import RobophmError, nearest

Array = npt.NDArray[np.float64]
Wrong = Callable[[str], RobophmError]
"""A function that makes an error of its message."""


def shown(value: object) -> str:
    """Return a value as an error shows it, cut short."""
    text = f"an array of shape {value.shape}" if isinstance(value, np.ndarray) else repr(value)
    return text if len(text) <= 60 else f"{text[:57]}…"


def number(value: Any, what: str, *, low: float = 0.0, high: float = math.inf, above: bool = False,
           whole: bool = False, error: Wrong = RobophmError) -> float:  # fmt: skip
    """A finite number of at least ``low``, or ``above`` it, and at most ``high``; raises ``error`` for any other.

    ``whole``: and no fraction.
    """
    try:
        fine = isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    except OverflowError:  # a whole number beyond all floats
        fine = False
    if not fine or (whole and value % 1) or not (value > low if above else value >= low) or value > high:
        most = f" and at most {high:g}" if high < math.inf else ""
        least = "" if low == -math.inf else f" {'above' if above else 'of at least'} {low:g}"
        raise error(f"{what} {shown(value)}: expected a {'whole ' * whole}number{least}{most}")
    return float(value)


def floats(value: Any, what: str, error: Wrong = RobophmError) -> Array:
    """Numbers as an array of floats, whichever they are; raises ``error`` for what are none, texts among them."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.asarray("")
    if array.dtype.kind not in "biuf":
        raise error(f"{what} {shown(value)}: expected a number, or an array of numbers")
    return array.astype(float, copy=False)


def numbers(value: Any, what: str, *, low: float = 0.0, high: float = math.inf,
            error: Wrong = RobophmError) -> Array:  # fmt: skip
    """The same of one number or of an array of any shape, which it keeps."""
    array = floats(value, what, error)
    truth = np.asarray(value).dtype == bool
    if truth or not (np.isfinite(array) & (array >= low) & (array <= high)).all():
        most = f" and at most {high:g}" if high < math.inf else ""
        raise error(f"{what} {shown(value)}: expected numbers of at least {low:g}{most}")
    return array


def instance(value: Any, kind: Any, what: str, expected: str, error: Wrong = RobophmError) -> Any:
    """A value that is of a kind, as of ``isinstance``; raises ``error`` for any other."""
    if not isinstance(value, kind):
        raise error(f"{what} {shown(value)}: expected {expected}")
    return value


def path(value: Any, what: str, error: Wrong) -> Path:
    """Return the path of a file; raises ``error`` for what is no path, or names no file."""
    if not isinstance(value, str | os.PathLike) or not os.fspath(value) or isinstance(os.fspath(value), bytes):
        raise error(f"{what} {shown(value)}: expected the path of a file")
    found = value if isinstance(value, Path) else Path(value)  # to make one of one takes as long as to look
    try:
        found.exists()
    except OSError as why:  # too long; what is not allowed is told later
        raise error(f"{what} {shown(value)}: {why.strerror}") from None
    except ValueError:  # with a character that no path has
        raise error(f"{what} {shown(value)}: expected the path of a file") from None
    return found


def one_of(value: Any, known: Any, what: str, error: Wrong = RobophmError) -> Any:
    """A name that is known; raises ``error``, with the nearest that is, for any other."""
    if not isinstance(value, str) or value not in known:
        hint = nearest(value, known) if isinstance(value, str) else f"; known: {', '.join(known)}"
        raise error(f"no {what} {shown(value)}{hint}")
    return value
