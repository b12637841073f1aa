"""Groups drawn at random, the laws that all of them keep, and their lives by chance in plain NumPy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st
from solving import sharing, solved, standby

from robophm.blocks.diagram import LoadSharing, Standby
from robophm.core.waiting_time import mean_time, time_at
from robophm.groups.solved_group import SolvedGroup
from robophm.life.weibull import Weibull

GRID = np.exp(np.linspace(np.log(1e-3), np.log(3e6), 90))
"""Hours from the first seconds to far beyond all that lives."""


class Drawn(NamedTuple):
    """A standby group with one active member, or equal parts that share a load of which one may fail."""

    scales: tuple[float, ...]
    shapes: tuple[float, ...]
    dormancy: float = 0.0
    switch: float = 1.0
    exponent: float | None = None

    @property
    def group(self) -> Standby | LoadSharing:
        n = len(self.scales)
        if self.exponent is not None:
            return sharing(n, n - 1, self.exponent)
        return standby(n, 1, self.dormancy, self.switch)

    @property
    def lives(self) -> list[Weibull]:
        return [Weibull(*of) for of in zip(self.scales, self.shapes, strict=True)]


def groups(n: int) -> st.SearchStrategy[Drawn]:
    """Cold, warm and hot standby of n parts, and loads that they share."""
    scale, shape = st.floats(300, 3000), st.floats(0.6, 5)
    several = st.tuples(*[scale] * n), st.tuples(*[shape] * n)
    dormancy, switch = (
        st.sampled_from([0.0, 0.1, 1.0]) | st.floats(0, 1),
        st.sampled_from([1.0, 0.9]) | st.floats(0.5, 1),
    )
    spares = st.builds(lambda *of: Drawn(*of), *several, dormancy, switch)
    shared = st.builds(lambda a, b, c: Drawn((a,) * n, (b,) * n, exponent=c), scale, shape, st.floats(0, 3))
    return spares | spares | spares | shared


def curve(one: SolvedGroup, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """P(fails by then) and P(survives)."""
    hazard = one.lived(np.zeros(len(times)), times)
    return -np.expm1(-hazard), np.exp(-hazard)


def check_laws(drawn: Drawn) -> None:
    """R never rises; hazard is its slope; mean and quantiles are its own; a stretch may be split."""
    one = solved(drawn.group, drawn.lives)
    hazard = one.lived(np.zeros(len(GRID)), GRID)
    known = np.isfinite(hazard)
    assert np.all(known[GRID <= 600.0])
    assert np.all(np.diff(known.astype(int)) <= 0), "certain death is not survived"
    assert np.all(np.diff(hazard[known]) >= -1e-12 * hazard[known][1:])
    rate = one.rate(GRID[known & (hazard < 1e6)])
    assert np.all(rate >= 0)
    assert np.all(np.isfinite(rate))
    survives = np.array([0.95, 0.5, 0.05])
    early, median, late = times = time_at(lambda t: curve(one, t), 1 - survives, survives)
    assert early < median < late
    np.testing.assert_allclose(curve(one, times)[1], survives, rtol=1e-11)
    np.testing.assert_allclose(
        one.gathered(times * 0, times) + one.lived(times, times), one.gathered(times * 0, 2 * times), rtol=1e-11
    )
    step = times * 1e-4
    np.testing.assert_allclose(one.rate(times), one.lived(times - step, 2 * step) / (2 * step), rtol=1e-5)
    mean = mean_time(lambda t: curve(one, t))
    assert early / 20 < mean < 20 * late
    # By Simpson's rule in ln t: the integral of R·t; what lies before the grid is its first time.
    fine = np.exp(np.linspace(np.log(1e-3), np.log(3e6), 1201))
    area = curve(one, fine)[1] * fine
    width = np.log(fine[1] / fine[0])
    simpson = width / 3 * (area[0] + 4 * area[1:-1:2].sum() + 2 * area[2:-1:2].sum() + area[-1])
    assert abs(simpson + 1e-3 - mean) < 1e-6 * mean


def lives_by_chance(drawn: Drawn, samples: int, seed: int) -> np.ndarray:
    """When each of so many groups fails, told step by step; shape (samples,)."""
    random = np.random.default_rng(seed)
    ends = np.array([
        scale * random.weibull(shape, samples) for scale, shape in zip(drawn.scales, drawn.shapes, strict=True)
    ])  # fmt: skip
    if drawn.exponent is not None:
        n = len(ends)
        first, second = np.sort(ends, axis=0)[:2]
        return first + (second - first) / (n / (n - 1)) ** drawn.exponent
    now, done = ends[0].copy(), np.zeros(samples, dtype=bool)
    called = np.zeros(samples, dtype=bool)  # whether the switch has been called since the last one failed
    for spare in ends[1:]:
        missed = ~called & (random.random(samples) >= drawn.switch)
        done |= missed
        works = ~done & (spare > drawn.dormancy * now)
        now = np.where(works, now + spare - drawn.dormancy * now, now)
        called = ~works
    return now


def check_by_chance(drawn: Drawn, seed: int, samples: int = 100_000) -> None:
    """R at its own quartiles and the mean, each within five standard deviations."""
    one, lives = solved(drawn.group, drawn.lives), lives_by_chance(drawn, samples, seed)
    survives: Sequence[float] = (0.95, 0.5, 0.05)
    times = time_at(lambda t: curve(one, t), [1 - s for s in survives], survives)
    for time, expected in zip(times, survives, strict=True):
        assert abs(np.mean(lives > time) - expected) < 5 * np.sqrt(expected * (1 - expected) / samples)
    mean = mean_time(lambda t: curve(one, t))
    assert abs(lives.mean() - mean) < 5 * lives.std() / np.sqrt(samples)
