"""``python -m benchmarks.learned_rates``: do intervals of learned rates hold? Part of ``make calibrate``.

Robots of a fleet are given true rates apart from what learns of them: lognormal ones, where it takes gammas. They work
unequally long and fail at gaps that are drawn, and what ``robophm learn`` then says of each robot, of one more robot
and of the fleet's mean is held against the truth. And rates are stated several times too low, and learned from the
first few failures. Seeds are fixed.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from robophm.design.file import parse
from robophm.learning.rates.failure_log import Seen
from robophm.learning.rates.fleet import MEDIAN_SPREAD, StatedRateRatio
from robophm.learning.rates.rate_update import learn

ROBOTS = 10
FLEETS, RATES = 400, 2000
SPREADS, FAILURES = (0.3, 0.7), (1, 3, 10)
TOO_LOW, SEEN = (3.0, 5.0), (1, 2, 3, 5, 10)

LEAST = 0.86
"""Share of truths in 90 % intervals: of fleets, and of rates stated too low from the fifth failure on."""

LEAST_EARLY = 0.80
"""The same from the second failure on."""

_STATED = 1e-3
_DESIGN = parse(f"{{schema_version: 1, name: R, components: {{part: {{rate: {_STATED} /h}}}}}}")


def _share(spread: float | None) -> str:
    return "as is likely" if spread is None else f"{spread:.0%}"


def _holds(ratio: StatedRateRatio, truth: float) -> bool:
    return ratio.low <= truth <= ratio.high


@dataclass(frozen=True)
class OfFleets:
    """Shares of truths that 90 % intervals held, of fleets whose robots differ by so much."""

    spread: float | None
    """None: each fleet's is drawn, half-normal of the median that what learns takes for likely."""
    failures: float
    """Of a robot, on average."""
    too_low: float
    """Times that the stated rate is."""
    own: float
    next: float
    mean: float


def of_fleets(spread: float | None, failures: float, too_low: float, fleets: int, rng: np.random.Generator) -> OfFleets:
    """Fleets of ROBOTS robots; every one ``fleets`` times."""
    (mode,) = _DESIGN.modes
    held = np.zeros(3)
    for _ in range(fleets):
        differ = abs(rng.normal(0.0, MEDIAN_SPREAD / norm.ppf(0.75))) if spread is None else spread
        sigma = math.sqrt(math.log1p(differ**2))
        *ratios, another = (too_low * np.exp(sigma * rng.standard_normal(ROBOTS + 1) - sigma**2 / 2)).tolist()
        worked = failures / (_STATED * too_low) * np.exp(0.5 * rng.standard_normal(ROBOTS) - 0.125)
        seen = []
        for i, (ratio, hours) in enumerate(zip(ratios, worked.tolist(), strict=True)):
            ages = np.cumsum(rng.exponential(1 / (_STATED * ratio), 40 + int(20 * failures * ratio / too_low)))
            seen.append(Seen(mode, f"r{i}", float(np.sum(ages < hours)), _STATED * hours, hours))
        (found,) = learn(_DESIGN, seen)
        own = np.mean([_holds(one, truth) for one, truth in zip(found.fleet.robots, ratios, strict=True)])
        held += own, _holds(found.fleet.next, another), _holds(found.fleet.mean, too_low)
    own, another, mean = (held / fleets).tolist()
    return OfFleets(spread, failures, too_low, own, another, mean)


def of_stated_too_low(too_low: float, failures: int, rates: int, rng: np.random.Generator) -> float:
    """Share of truths in the interval when so many failures of one robot were seen."""
    (mode,) = _DESIGN.modes
    held = 0
    for hours in rng.gamma(failures, 1 / (_STATED * too_low), rates).tolist():
        (found,) = learn(_DESIGN, [Seen(mode, "r", failures, _STATED * hours, hours)])
        held += _holds(found.ratio, too_low)
    return held / rates


def scored(fleets: int = FLEETS, rates: int = RATES, seed: int = 1) -> tuple[list[OfFleets], dict[float, list[float]]]:
    """All of them: of fleets, and by how many times a rate was stated too low, of SEEN failures."""
    rng = np.random.default_rng(seed)
    of_each = [
        of_fleets(spread, failures, too_low, fleets, rng)
        for too_low in (1.0, 3.0) for spread in SPREADS for failures in FAILURES
    ]  # fmt: skip
    stated = {times: [of_stated_too_low(times, n, rates, rng) for n in SEEN] for times in TOO_LOW}
    return of_each + [of_fleets(None, failures, 1.0, fleets, rng) for failures in FAILURES], stated


def faults(fleets: list[OfFleets], stated: dict[float, list[float]], margin: float = 0.0) -> list[str]:
    """What holds less often than it should, beyond a margin for chance."""
    found = [
        f"robots that differ by {_share(one.spread)} and fail {one.failures:g} times: that of {name} held {share:.1%}"
        for one in fleets
        for name, share in (("each", one.own), ("the next", one.next), ("their mean", one.mean))
        if share < LEAST - margin
    ]
    found += [
        f"stated {times:g} times too low, {n} failures: the interval held {share:.1%}"
        for times, shares in stated.items() for n, share in zip(SEEN, shares, strict=True)
        if share < (LEAST if n >= 5 else LEAST_EARLY if n >= 2 else 0.0) - margin
    ]  # fmt: skip
    return found


def text(fleets: list[OfFleets], stated: dict[float, list[float]]) -> list[str]:
    """As tables."""
    lines = ["robots differ   failures of each   stated too low   own     next    mean    (in 90 % intervals)"]
    lines += [
        f"{_share(one.spread):>13} {one.failures:18g} {one.too_low:14g} x"
        + "".join(f" {share:7.1%}" for share in (one.own, one.next, one.mean))
        for one in fleets
    ]
    lines += ["", "stated too low   " + "".join(f"{n:6d}." for n in SEEN) + " failure"]
    return lines + [f"{times:12g} x   " + "".join(f"{share:7.1%}" for share in some) for times, some in stated.items()]


def main() -> int:
    found = scored()
    wrong = faults(*found)
    print("\n".join([*text(*found), "", *(wrong or ["honest"])]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
