"""Many quick cases of one law as one test: the case that fails is named."""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import pytest

Test = Callable[..., None]


def each_case(names: str | Sequence[str], cases: Iterable[Any], ids: object = None) -> Callable[[Test], Test]:
    """Run a test over all cases, as ``pytest.mark.parametrize`` does, without a test of pytest's for each.

    To pytest each of some thousand cases costs more than what it tries. Fixtures are shared by the cases of a test.
    """
    keys = tuple(name.strip() for name in names.split(",")) if isinstance(names, str) else tuple(names)
    all_cases = [(case,) if len(keys) == 1 and isinstance(names, str) else tuple(case) for case in cases]
    assert all_cases, f"no case of {names}"

    def decorate(test: Test) -> Test:
        @functools.wraps(test)
        def run(**fixtures: Any) -> None:
            for case in all_cases:
                said = dict(zip(keys, case, strict=True))
                try:
                    test(**said, **fixtures)
                except pytest.skip.Exception:
                    raise
                except BaseException as error:
                    error.add_note(f"case: {', '.join(f'{key}={value!r}' for key, value in said.items())}")
                    raise

        whole = inspect.signature(test)
        rest = [parameter for key, parameter in whole.parameters.items() if key not in keys]
        run.__signature__ = whole.replace(parameters=rest)  # type: ignore[attr-defined]
        return run

    return decorate


def examples(number: int) -> int:
    """How many random examples a law is tried on: a third of the number, all by ``make test-full``."""
    return number if os.environ.get("EXAMPLES") == "all" else max(1, number // 3)


def some(cases: Iterable[Any]) -> list[Any]:
    """Of many alike cases of a law every third one, all by ``make test-full``."""
    return list(cases)[:: 1 if os.environ.get("EXAMPLES") == "all" else 3]
