"""Unavailability of what is tested now and then (MEF 2.0d, section 4.3.2): with 4, 5 or 11 arguments.

Between tests a part works, has failed unseen, or is repaired; a test finds what has failed. With four arguments repair
takes no time, with five a test takes none; with eleven it does, may fail the part, miss a failure or spoil the restart.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

MOST_TESTS = 100_000
"""The most tests until the mission time."""


class _Part(NamedTuple):
    """The probabilities that a part has failed unseen, and that it is under repair; else it works."""

    failed: float
    repaired: float

    @property
    def works(self) -> float:
        return 1.0 - self.failed - self.repaired

    def after(self, time: float, rate: float, repair: float, restart: float) -> _Part:
        """The part after a stretch without tests."""
        fails, done = -math.expm1(-rate * time), -math.expm1(-repair * time)
        again = done * restart + (1 - restart) * _one_then_other(repair, rate, time)
        return _Part(self.works * fails + self.failed + self.repaired * again, self.repaired * (1 - done))


def unavailability(*said: float) -> float:
    """Return the probability that a part is not available at the mission time, from the arguments of a periodic test.

    Raises ValueError for times, rates or probabilities that cannot be, and for too many tests.
    """
    kinds: Mapping[int, Callable[..., float]] = {4: _at_once, 5: _repaired, 11: _tested}
    if len(said) not in kinds:
        raise ValueError
    return kinds[len(said)](*said)


def _at_once(rate: float, every: float, first: float, time: float) -> float:
    """Of what is as new after each test; at the moment of a test, that right before it."""
    _positive(rate, every)
    since = time if time <= first else (time - first) % every or every
    return -math.expm1(-rate * since)


def _repaired(rate: float, repair: float, every: float, first: float, time: float) -> float:
    return _tested(rate, rate, repair, every, first, 0.0, 0.0, 1.0, 1.0, 0.0, time)


def _tested(
    rate: float, test_rate: float, repair: float, every: float, first: float, fails_at_start: float, lasts: float,
    available: float, found: float, restart: float, time: float,
) -> float:  # fmt: skip
    """Of what is repaired at a rate once a test has found it, where tests take time."""
    _positive(rate, every)
    if min(repair, test_rate, first, time, lasts) < 0 or lasts > every:
        raise ValueError
    if not all(0 <= one <= 1 for one in (fails_at_start, found, restart)):
        raise ValueError
    part = _Part(-math.expm1(-rate * min(time, first)), 0.0)
    if time <= first:
        return part.failed
    tests, left = divmod(time - first, every)
    if tests > MOST_TESTS:
        raise ValueError

    def test(part: _Part, time: float) -> _Part:
        fails, done = -math.expm1(-test_rate * time), -math.expm1(-repair * time)
        again = done * restart + (1 - restart) * _one_then_other(repair, rate, time)
        seen = part.failed + part.works * (fails_at_start + (1 - fails_at_start) * fails)
        return _Part(part.repaired * again + (1 - found) * seen, (1 - done) * part.repaired + found * seen)

    for _ in range(int(tests)):
        part = test(part, lasts).after(every - lasts, rate, repair, restart)
    if left > lasts or not lasts:
        return 1 - test(part, lasts).after(left - lasts, rate, repair, restart).works
    under_test = part.works * (1 - fails_at_start) * math.exp(-test_rate * left)
    return 1 - test(part, left).works + (0.0 if available else under_test)


def _one_then_other(first: float, second: float, time: float) -> float:
    """P(something at the first rate, and then something at the second, within a time)."""
    apart = (first - second) * time
    if abs(apart) < 1e-6:  # what they are at equal rates, and the next term
        both = first * time * math.exp(-second * time) * (1 - apart / 2)
    elif apart > 700:  # at once
        return -math.expm1(-second * time)
    else:
        both = first / (first - second) * (math.exp(-second * time) - math.exp(-first * time))
    return -math.expm1(-first * time) - both


def _positive(*said: float) -> None:
    if min(said) <= 0:
        raise ValueError
