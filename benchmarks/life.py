"""Life distributions over a million ages, against one bare pass of np.exp over as many numbers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from benchmarks import Line, agree, benchmark, race
from robophm.life import life_distribution

N = 1_000_000


def lives() -> Iterator[tuple[str, Any, Any]]:
    """Ours, and the same of SciPy to compare answers with."""
    from scipy import stats

    yield "exponential", life_distribution("exponential")(rate=1e-4), stats.expon(scale=1e4)
    yield "weibull", life_distribution("weibull")(scale=2e4, shape=1.7), stats.weibull_min(1.7, scale=2e4)
    lognormal = life_distribution("lognormal")(log_mean=9.0, log_deviation=1.0)
    yield "lognormal", lognormal, stats.lognorm(1.0, scale=np.exp(9.0))


@benchmark
def ages() -> Iterator[Line]:
    rng = np.random.default_rng(4)
    age = 10 ** rng.uniform(3.0, 5.0, N)
    duration = rng.uniform(10.0, 1000.0, N)
    exponent = -age / 1e4
    for name, life, scipy in lives():
        few = slice(0, 10_000)
        plain = scipy.logsf(age[few]) - scipy.logsf(age[few] + duration[few])
        agree(f"{name} increment", life.increment(age[few], duration[few]), plain, 1e-8)
        agree(f"{name} hazard", life.hazard(age[few]), scipy.pdf(age[few]) / scipy.sf(age[few]), 1e-9)
        increment, hazard, bare = race(
            lambda life=life: life.increment(age, duration),
            lambda life=life: life.hazard(age),
            lambda: np.exp(exponent),
        )
        yield Line(f"{name}, a million ages: increment of H", increment, bare, "np.exp")
        yield Line(f"{name}, a million ages: hazard", hazard, bare, "np.exp")
