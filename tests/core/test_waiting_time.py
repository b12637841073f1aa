"""Quantiles and means of random times, from curves in closed form; expected values by mpmath."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.special import log_ndtr

from robophm.core.waiting_time import Array, Curve, mean_time, time_at

SCALE = 1234.5


@pytest.fixture(autouse=True, scope="module")
def digits() -> Iterator[None]:
    with mp.workdps(80):
        yield


def weibull(beta: float) -> Curve:
    return lambda t: (-np.expm1(-((t / SCALE) ** beta)), np.exp(-((t / SCALE) ** beta)))


def loglogistic(beta: float) -> Curve:
    return lambda t: (1 / (1 + (t / SCALE) ** -beta), 1 / (1 + (t / SCALE) ** beta))


def lognormal(sigma: float) -> Curve:
    return lambda t: tuple(np.exp(log_ndtr(sign * np.log(t / SCALE) / sigma)) for sign in (1, -1))  # type: ignore[return-value]


def pair(t: Array) -> tuple[Array, Array]:
    """Two equal parts in parallel."""
    q, p = weibull(1)(t)
    return q * q, p * (1 + q)


def quantile_of_normal(q: mpf, p: mpf) -> mpf:
    if q > p:
        return -quantile_of_normal(p, q)
    return mp.findroot(lambda z: mp.log(mp.ncdf(z) / q), -mp.sqrt(-2 * mp.log(q)))


PROBABILITIES = [1e-30, 1e-12, 0.05, 0.5]
INVERSES: list[tuple[str, Curve, Callable[[mpf, mpf], mpf]]] = [
    # each from (failed, survives) to time / SCALE
    ("exponential", weibull(1), lambda q, p: -mp.log(p)),
    ("weibull 0.5", weibull(0.5), lambda q, p: mp.log(p) ** 2),
    ("weibull 4", weibull(4), lambda q, p: (-mp.log(p)) ** mpf(0.25)),
    ("loglogistic", loglogistic(1.5), lambda q, p: (q / p) ** (1 / mpf(1.5))),
    ("pair", pair, lambda q, p: -mp.log(p / (1 + mp.sqrt(q)))),
    ("lognormal", lognormal(0.7), lambda q, p: mp.exp(mpf(0.7) * quantile_of_normal(q, p))),
]  # fmt: skip


@pytest.mark.parametrize(("curve", "inverse"), [row[1:] for row in INVERSES], ids=[row[0] for row in INVERSES])
def test_quantiles_in_both_tails(curve: Curve, inverse: Callable[[mpf, mpf], mpf]) -> None:
    small = [mpf(p) for p in PROBABILITIES]
    pairs = [(q, 1 - q) for q in small] + [(1 - p, p) for p in small]
    expected = [float(SCALE * inverse(q, p)) for q, p in pairs]
    with np.errstate(over="ignore"):
        found = time_at(curve, [float(q) for q, _ in pairs], [float(p) for _, p in pairs])
    assert found == pytest.approx(expected, rel=1e-12, abs=0)


def test_what_never_comes_and_what_has_been() -> None:
    half = np.array([0.2, 0.5])
    never = time_at(lambda t: (np.full(t.shape, 0.3), np.full(t.shape, 0.7)), half, 1 - half)
    assert never.tolist() == [0.0, math.inf]
    assert mean_time(lambda t: (np.full(t.shape, 0.3), np.full(t.shape, 0.7))) == math.inf
    assert mean_time(lambda t: (np.ones(t.shape), np.zeros(t.shape))) == 0.0


@pytest.mark.parametrize(
    ("curve", "expected"),
    [
        (weibull(1), 1),
        (weibull(0.3), mp.gamma(1 + 1 / mpf(0.3))),
        (weibull(0.7), mp.gamma(1 + 1 / mpf(0.7))),
        (weibull(5), mp.gamma(mpf(1.2))),
        (lognormal(0.2), mp.exp(mpf(0.2) ** 2 / 2)),
        (lognormal(1.5), mp.exp(mpf(1.5) ** 2 / 2)),
        (loglogistic(1.2), mp.pi / mpf(1.2) / mp.sin(mp.pi / mpf(1.2))),
        (loglogistic(1.5), mp.pi / mpf(1.5) / mp.sin(mp.pi / mpf(1.5))),
        (loglogistic(3), mp.pi / 3 / mp.sin(mp.pi / 3)),
        (loglogistic(1), mp.inf),
        (loglogistic(0.8), mp.inf),
        (pair, mpf(1.5)),
    ],
)
def test_mean(curve: Curve, expected: mpf) -> None:
    with np.errstate(over="ignore"):
        assert mean_time(curve) == pytest.approx(float(SCALE * expected), rel=1e-10)


def test_a_kink_costs_no_digits() -> None:
    """A part that cannot fail for 700 h beside an exponential one: 1000 + 700 + 500·√π/2 less the pair in series."""

    def weibull(t: Array) -> Array:
        return np.minimum((np.maximum(t - 700, 0) / 500), 1e3) ** 2

    def parallel(t: Array) -> tuple[Array, Array]:
        a, b = 1e-3 * t, weibull(t)
        return np.expm1(-a) * np.expm1(-b), np.exp(-a) + np.exp(-b) * -np.expm1(-a)

    def series(t: Array) -> tuple[Array, Array]:
        return -np.expm1(-1e-3 * t - weibull(t)), np.exp(-1e-3 * t - weibull(t))

    # in series: 700 h of the exponential, then both
    both = mp.quad(lambda x: mp.exp(-x / 1000 - (x / 500) ** 2), [0, 500, 1000, 2000, 5000])
    pair = 1000 * (1 - mp.exp(-mpf("0.7"))) + mp.exp(-mpf("0.7")) * both
    assert mean_time(series) == pytest.approx(float(pair), rel=1e-11)
    assert mean_time(parallel) == pytest.approx(float(1700 + 250 * mp.sqrt(mp.pi) - pair), rel=1e-11)
