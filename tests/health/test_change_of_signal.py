"""Changes of a signal against its past: SciPy beside the test of a trend, plain loops beside that of a jump."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import linregress

from robophm.health.change_of_signal import DAY, SETTLED, Change, change_of, trend_chance

START = 1_700_006_400 * 10**9  # midnight


def remembering(random: np.random.Generator, n: int, memory: float) -> np.ndarray:
    """A series without a trend, each value of which remembers the one before."""
    noise, values = random.normal(size=n), np.empty(n)
    values[0] = noise[0] / np.sqrt(1 - memory**2)
    for i in range(1, n):
        values[i] = memory * values[i - 1] + noise[i]
    return values


@pytest.mark.parametrize("n", [14, 60, 128])
def test_the_chance_of_a_trend_without_memory_is_that_of_the_peer(n: int) -> None:
    """Where a value is rather against the one before, as here, all values count in full."""
    random = np.random.default_rng(n)
    for slope in (0.0, 0.01, 0.3):
        values = remembering(random, n, -0.9) + slope * np.arange(n)
        assert trend_chance(values) == pytest.approx(linregress(np.arange(n), values).pvalue, rel=1e-9)


@pytest.mark.parametrize(("memory", "days", "most"), [(0.0, 30, 4), (0.5, 60, 7), (0.8, 128, 4)])
def test_a_signal_without_a_drift_is_seldom_told_of(memory: float, days: int, most: int) -> None:
    """As often as the module says, and what chance adds: one more than the 95 % point of so many (Poisson)."""
    random = np.random.default_rng([days, 7])
    ends = START + DAY * np.arange(1, days + 1)
    found = [change_of(ends, remembering(random, days, memory), 0.0) for _ in range(1000)]
    assert sum(change is not None and change.drift for change in found) <= most


def test_a_clear_drift_is_found_whatever_is_remembered() -> None:
    random = np.random.default_rng(9)
    ends = START + DAY * np.arange(1, 129)
    for memory in (0.0, 0.5, 0.8):
        rise = np.linspace(0, 12 / np.sqrt(1 - memory**2), 128)
        found = [change_of(ends, remembering(random, 128, memory) + rise, 0.0) for _ in range(50)]
        assert sum(change is not None for change in found) >= 40


def jumped(ends: np.ndarray, values: np.ndarray, accuracy: float) -> int | None:
    """The stretch that a jump begins after, found by trying each."""
    for k in range(1, len(values) - 1):
        past, since = values[:k], values[k:]
        spread = max(past.max() - past.min(), accuracy)
        if ends[k - 1] - ends[0] >= SETTLED and (
            since.min() - past.max() > spread or past.min() - since.max() > spread
        ):
            return k
    return None


def test_a_jump_is_where_all_that_follows_lies_beyond() -> None:
    random = np.random.default_rng(4)
    ends = START + DAY // 4 * np.arange(1, 41)
    seen = 0
    for _ in range(300):
        values = random.normal(20, 1, 40)
        place, by = random.integers(1, 40), random.choice([-1, 1]) * random.uniform(0, 20)
        values[place:] += by
        found, expected = change_of(ends, values, 2.0), jumped(ends, values, 2.0)
        assert (found and not found.drift and found.since) == (None if expected is None else ends[expected - 1])
        if found and expected is not None:
            assert found.before == np.median(values[:expected])
            assert found.by == np.median(values[expected:]) - found.before
            seen += 1
    assert 30 < seen < 270


def test_a_drift_is_told_with_its_chance() -> None:
    """A tenth of a degree a day for sixty days, over a course of the day ten times as large."""
    random = np.random.default_rng(5)
    hours = np.arange(1, 60 * 24 + 1, 6)
    values = 30 + 5 * np.sin(2 * np.pi * hours / 24) + 0.1 * hours / 24 + random.normal(0, 0.5, len(hours))
    found = change_of(START + hours * DAY // 24, values, 3.0)
    assert found is not None
    assert found.drift
    assert found.by == pytest.approx(4.5, abs=0.5)  # from the middle of the first quarter to that of the last
    assert found.words("degC").startswith("has risen by 4.")
    assert change_of(START + hours * DAY // 24, values, 6.0) is None  # too small to be told of
    assert change_of(START + hours[:40] * DAY // 24, values[:40], 0.0) is None  # ten days are too few


@pytest.mark.parametrize("values", [[], [1.0], [1.0, 1.0], [np.nan] * 50, [5.0] * 50])
def test_nothing_is_told_of_what_is_too_short_or_never_changes(values: list[float]) -> None:
    assert change_of(START + DAY * np.arange(len(values)), np.array(values), 0.0) is None


def test_it_is_said_in_words() -> None:
    assert Change(START, -12.34, 50.0).words("degC") == (
        "has been 12.3 °C lower since 2023-11-15 00:00:00 UTC, beyond all that it said before"
    )
