"""False and true findings of differences between cohorts: ``python -m benchmarks.fleet_cohorts [--looks 200]``.

Each look is at fleets whose robots differ by what they please and work unequally long, of five parts, with three sites
and two years; one of the sites has worked four times as long as the others. Exits with 1 where more looks at fleets
without a difference find one than 5 % and chance allow.
"""

from __future__ import annotations

import argparse
import sys
from typing import NamedTuple

import numpy as np
from scipy.stats import binom

from robophm.learning.rates.cohorts import FALSE_RATE, adjusted, compare_cohort
from robophm.learning.rates.fleet import Powers
from robophm.learning.rates.gamma_poisson import update
from robophm.learning.rates.rate_update import Promised

PARTS = 5


class Found(NamedTuple):
    """What looks at fleets found."""

    true: int
    """Looks in which the site that differs was found to, in the part in which it does."""
    false: int
    """Looks in which anything else was found to differ, without what the difference itself brings about."""


def looks(
    rng: np.random.Generator,
    number: int,
    robots: int,
    each: float,
    spread: float,
    times: float = 1.0,
    *,
    parts: int = PARTS,
) -> Found:
    """Look at fleets of so many robots with so many failures expected of each part of each.

    ``spread``: of the lognormal rates of robots, of deviation of the logarithm; ``times``: how many times the rate of
    all others the first site has in the first part; of a part that truly differs only that site is judged.
    """
    site, year = np.arange(robots) % 3, np.arange(robots) * 2 // robots
    true = false = 0
    for _ in range(number):
        chances, of = [], []
        for part in range(parts):
            worked = each * rng.uniform(0.2, 1.8, robots) * np.where(site == 2, 4.0, 1.0)
            own = np.exp(spread * rng.standard_normal(robots) - spread**2 / 2)
            differs = times if part == 0 else 1.0
            failures = rng.poisson(worked * own * np.where(site == 0, differs, 1.0)).astype(float)
            told = Promised(failures.tolist(), Powers(worked, 1.0), update(failures.sum(), float(worked.sum()), 1.0))
            for kind, cohorts in ((site, 3), (year, 2)):
                for cohort in range(cohorts):
                    one = compare_cohort(told, kind == cohort)
                    if one and failures.any():
                        chances.append(one.chance)
                        of.append((part, kind is site, cohort))
        found = {key for key, chance in zip(of, adjusted(chances), strict=True) if chance <= FALSE_RATE}
        true += (0, True, 0) in found
        false += any(part or times == 1 for part, *_ in found)
    return Found(true, false)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fleet_cohorts", description=__doc__)
    parser.add_argument("--looks", type=int, default=200)
    number, rng, worst = parser.parse_args().looks, np.random.default_rng(1), 0
    print("robots  failures of each  robots differ  looks with a false finding")
    for robots, each, spread in ((12, 1.0, 0.0), (12, 1.0, 0.7), (60, 0.2, 0.7), (60, 1.0, 0.7), (60, 1.0, 1.0)):
        false = looks(rng, number, robots, each, spread).false
        worst = max(worst, false)
        print(f"{robots:>6} {each:>17g} {spread:>14g}  {false} of {number}", flush=True)
    print("robots  failures of each  robots differ  a third of them  looks that find it")
    for robots, each, times in ((12, 1.0, 5.0), (60, 0.2, 3.0), (60, 0.2, 5.0), (60, 1.0, 3.0)):
        found = looks(rng, number, robots, each, 0.3, times)
        print(f"{robots:>6} {each:>17g} {0.3:>14g} {times:>13g} x  {found.true} of {number}", flush=True)
    return int(worst > binom.ppf(0.999, number, FALSE_RATE))


if __name__ == "__main__":
    sys.exit(main())
