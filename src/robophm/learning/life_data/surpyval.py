"""SurPyval, which fits life data: imported when something is fitted, and only then."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from robophm.core.errors import DataError, RobophmError


def library(part: str = "") -> Any:
    """The library, or a module of it. Raises RobophmError where it is not installed."""
    try:
        return import_module(f"surpyval{part and '.' + part}")
    except ImportError as error:
        raise RobophmError(f"fitting needs SurPyval ({error.name or error}). Install robophm[fit]") from None


@contextmanager
def asked(what: str) -> Iterator[list[str]]:
    """Run SurPyval: its refusals become DataError, its warnings texts in the list."""
    said: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            yield said
        except (ValueError, ArithmeticError, RuntimeError, NotImplementedError) as error:
            raise DataError(f"{what}: {' '.join(str(error).split())}") from None
        finally:
            said += [" ".join(str(one.message).split()) for one in caught if issubclass(one.category, UserWarning)]
