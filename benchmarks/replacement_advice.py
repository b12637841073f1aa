"""``python -m benchmarks.replacement_advice [SET ...]``: does replacement by condition cost what was promised?

``robophm maintain`` says at which level of wear to replace a part, how often to look, and what that will cost. Here it
advises by units that wore out, and each unit that it has not seen then lives by that, along its own readings: looked at
when it is due, replaced where it reads that much, failed when it first crosses its threshold. So do all units of a set
by the advice that one of them gives alone, of a share λ of its life. A failure costs five times as much as a
replacement in time, a look a fiftieth. Costs are per mean life, in replacements: 1 would be one just before each end,
without a look, and 5 is what it costs to wait for failures. Simulated parts (``simulation/worn_robots.py``, which
shares nothing with the engine) come first; exits with 1 where these cost more than was promised, beyond chance (1 %).
Measured sets (``benchmarks/prognostics.py``) follow where they are at hand. Part of ``make calibrate``.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from benchmarks.prognostics import DATA, SETS, Array, crossing, readings
from robophm.core.errors import DataError
from robophm.learning.maintenance.condition_based import INTERVALS, LEVELS, WearPaths, best_condition_policy
from robophm.learning.maintenance.replacement_age import Costs
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.possible_paths import PossiblePaths, paths_of_forecast, paths_of_others
from robophm.simulation.worn_robots import LIMITS, worn_out

COSTS, LOOK = Costs(1.0, 5.0), 0.02
SHARES = (0.5, 0.7)
"""Of its life, at which one part alone gives advice."""
TEACHERS, FLEETS, SEED = 10, 30, 2026
"""Of simulated parts: how many teach the next ten, and how many times."""
CHANCE = 2.33
"""Standard errors beyond which more was paid than promised: 1 %, one-sided."""


class Cycle(NamedTuple):
    """What one part cost until it was replaced."""

    spent: float
    lasted: float
    failed: float


class Life(NamedTuple):
    """A part that wore out, from its first reading on."""

    times: Array
    values: Array
    threshold: float
    end: float

    @property
    def unit(self) -> Unit:
        return Unit(self.times, self.values, self.threshold, failed=self.end)

    def inspected(self, level: float, interval: float) -> Cycle:
        """Look every ``interval``; replace where it reads ``level`` or is beyond it."""
        sign = 1.0 if self.threshold > self.values[0] else -1.0
        looks = np.arange(1, int(np.ceil(self.end / interval))) * interval
        found = np.flatnonzero(sign * np.interp(looks, self.times, self.values) >= sign * level)
        if len(found):
            first = int(found[0])
            return Cycle(COSTS.preventive + LOOK * (first + 1), float(looks[first]), 0.0)
        return Cycle(COSTS.corrective + LOOK * len(looks), self.end, 1.0)

    def by_age(self, age: float | None) -> Cycle:
        failed = age is None or self.end <= age
        return Cycle(COSTS.corrective, self.end, 1.0) if failed else Cycle(COSTS.preventive, age or 0.0, 0.0)


@dataclass(frozen=True)
class Advice:
    """What was advised and promised, and what came of it."""

    level: float
    """Share of the way to the threshold."""
    interval: float
    rate: float
    fails: float
    by_age: float
    inspected: Sequence[Cycle]
    aged: Sequence[Cycle]


def per_time(cycles: Sequence[Cycle]) -> float:
    """Cost per time, by renewal reward."""
    return sum(one.spent for one in cycles) / sum(one.lasted for one in cycles)


def advised(paths: PossiblePaths, lives: Sequence[Life]) -> Advice:
    """The advice by paths, and what parts cost that live by it."""
    policy = best_condition_policy(WearPaths(paths.wear, paths.lives, paths.noise), COSTS, LOOK)
    return Advice(
        policy.level, policy.interval, policy.cost_rate, policy.fails, policy.by_age,
        [one.inspected(paths.new + policy.level * paths.way, policy.interval) for one in lives],
        [one.by_age(policy.age) for one in lives],
    )  # fmt: skip


def of_others(lives: Sequence[Life]) -> list[Advice]:
    """Each life by the advice of all others."""
    return [
        advised(paths_of_others([one.unit for one in lives if one is not life], life.threshold), [life])
        for life in lives
    ]


def of_one(lives: Sequence[Life], share: float) -> list[Advice]:
    """All lives by the advice of each alone, at a share of its own; those of which nothing is foretold are left out."""
    found = []
    for life in lives:
        known = life.times <= share * life.end
        times, values = life.times[known], life.values[known]
        try:
            said = forecast(times, values, life.threshold, falls=life.threshold < life.values[0])
            found.append(advised(paths_of_forecast(said, times, values), lives))
        except DataError:
            continue
    return found


def measured(name: str) -> list[Life]:
    """The lives of a measured set."""
    one, found = SETS[name], []
    for unit, (t, y) in readings(one.file).items():
        if (end := crossing(t, y, one.limit(unit), falls=one.falls)) is not None:
            found.append(Life(t - t[0], y, one.limit(unit), end - float(t[0])))
    return found


def simulated(part: str) -> tuple[list[Life], list[Advice]]:
    """Parts of a kind, ten by ten by the advice of ten others; they end with their last reading, whatever it says."""
    each, found, lived = worn_out(part, FLEETS * 2 * TEACHERS, SEED), list[Advice](), list[Life]()
    lives = [Life(np.arange(float(len(wear))), wear, LIMITS[part], len(wear) - 1.0) for wear in each]
    for k in range(0, len(lives) - 2 * TEACHERS + 1, 2 * TEACHERS):
        teachers, next_ones = lives[k : k + TEACHERS], lives[k + TEACHERS : k + 2 * TEACHERS]
        found.append(advised(paths_of_others([one.unit for one in teachers], LIMITS[part]), next_ones))
        lived += next_ones
    return lived, found


def in_hindsight(lives: Sequence[Life]) -> float:
    """The least that one level and one interval could have cost all of them."""
    mean = float(np.mean([one.end for one in lives]))
    new, goal = lives[0].values[0], lives[0].threshold
    return min(
        per_time([one.inspected(new + share * (goal - new), interval) for one in lives])
        for share in LEVELS[9::3].tolist() for interval in (INTERVALS[15::3] * mean).tolist()
    )  # fmt: skip


def row(name: str, by: str, lives: Sequence[Life], found: Sequence[Advice]) -> str:
    """One row of the table."""
    mean = float(np.mean([one.end for one in lives]))
    inspected, aged = [one for each in found for one in each.inspected], [one for each in found for one in each.aged]
    costs = [
        np.mean([one.rate for one in found]), per_time(inspected), np.mean([one.by_age for one in found]),
        per_time(aged), in_hindsight(lives),
    ]  # fmt: skip
    said, came, said_age, came_age, best = (f"{mean * one:.2f}" for one in costs)
    level, interval = (float(np.median([getattr(one, what) for one in found])) for what in ("level", "interval"))
    fails = f"{np.mean([one.fails for one in found]):.3f} / {np.mean([one.failed for one in inspected]):.3f}"
    return (
        f"| {name} | {by} | {len(inspected)} | {level:.2f} | {interval / mean:.3f} | {said} / {came} | {fails} "
        f"| {said_age} / {came_age} | {best} |"
    )


def excess(found: Sequence[Advice]) -> float:
    """Standard errors by which more was paid than promised, fleet by fleet."""
    over = np.array([
        sum(one.spent for one in each.inspected) - each.rate * sum(one.lasted for one in each.inspected)
        for each in found
    ])  # fmt: skip
    return float(over.mean() / (over.std(ddof=1) / np.sqrt(len(over))))


def rows(wanted: Sequence[str]) -> Iterator[str]:
    """Rows of the measured sets that are wanted."""
    for name in SETS:
        if SETS[name].since_damage or (wanted and not any(name.lower().startswith(one.lower()) for one in wanted)):
            continue
        lives = measured(name)
        if len(lives) > 1:
            yield row(name, "the others", lives, of_others(lives))
        for share in SHARES:
            if found := of_one(lives, share):
                yield row(name, f"one alone at {share:g} ({len(found)} of {len(lives)} said)", lives, found)
            else:
                yield f"| {name} | one alone at {share:g} | 0 | none is said | | | | | |"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.replacement_advice", description="is advice honest")
    parser.add_argument("sets", nargs="*", metavar="SET", help="the start of a measured set's name; default all")
    asked = parser.parse_args()
    print("| parts | advised by | lives | replace at | look every | cost promised / came | fail promised / came "
          "| by age promised / came | best in hindsight |\n" + "|---" * 9 + "|")  # fmt: skip
    honest, verdicts = True, []
    for part in LIMITS:
        lives, found = simulated(part)
        print(row(f"{part}, simulated", f"{TEACHERS} others", lives, found), flush=True)
        verdicts.append(f"{part} {excess(found):+.1f}")
        honest = honest and excess(found) < CHANCE
    if DATA.is_dir():
        for line in rows(asked.sets):
            print(line, flush=True)
    print(f"\nSimulated parts cost more than promised by so many standard errors: {', '.join(verdicts)}; beyond "
          f"{CHANCE} it is not chance\n{'honest' if honest else 'not honest'}")  # fmt: skip
    return 0 if honest else 1


if __name__ == "__main__":
    sys.exit(main())
