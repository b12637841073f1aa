"""Rates of each cohort of a fleet, and which of the differences between cohorts are real."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from robophm.design.robot import FailureMode
from robophm.fleet.experience import Experience, ObservedRobot, Origin
from robophm.learning.rates.cohorts import FALSE_RATE, CohortComparison, adjusted, compare_cohort
from robophm.learning.rates.failure_log import Seen
from robophm.learning.rates.rate_update import LearnedRate, Promised, learn, promised

KINDS: dict[str, Callable[[Origin], str | None]] = {
    "design": lambda one: one.design,
    "version": lambda one: one.version and f"{one.design} {one.version}",
    "site": lambda one: one.site,
    "year": lambda one: one.year,
}
"""The ways in which robots are put together: what a robot's cohort is called in each; None where that is not known."""


_STATED = np.zeros((1, 1))  # ln θ of the rate as stated


class Compared(NamedTuple):
    """A failure mode in the robots of one cohort beside all others that have it."""

    mode: str
    clock: str
    kind: str
    """One of KINDS."""
    cohort: str
    robots: int
    exposure: float
    """Exposure of all parts of the cohort together [unit of the mode's clock]."""
    stated: float
    """Failures expected by the stated rate."""
    found: CohortComparison
    chance: float
    """The chance as if this were the only comparison of this look (Holm)."""

    @property
    def real(self) -> bool:
        """Whether the cohort differs from the others, by more than robots do anyway."""
        return self.chance <= FALSE_RATE

    def to_json(self) -> dict[str, Any]:
        """Return it as plain values for JSON."""
        document, found, (low, high) = self._asdict(), self.found, self.found.times
        del document["found"]
        return document | {
            "failures": found.failures, "by_the_others": found.others.expected, "low": low, "high": high,
            "alone": found.chance, "real": self.real,
        }  # fmt: skip


class CohortRate(NamedTuple):
    """The rate of a failure mode as the robots of one cohort alone have it."""

    design: str
    cohort: str
    robots: int
    learned: LearnedRate
    """The rate by their failures; ``fleet.mean`` is that of the cohort, ``fleet.next`` that of a further robot."""


def cohort_rates(designs: Sequence[Experience], kind: str, prior: str | None = None) -> list[CohortRate]:
    """Return the rates of each cohort of a kind, design by design, of modes of which anything was seen in it.

    ``kind``: one of KINDS. Raises DataError.
    """
    found = []
    for experience in designs:
        cohorts: dict[str, list[ObservedRobot]] = defaultdict(list)
        for robot in experience.robots:
            if (name := KINDS[kind](robot.origin)) is not None:
                cohorts[name].append(robot)
        for cohort, robots in sorted(cohorts.items()):
            seen = [seen for robot in robots for seen in robot.seen]
            found += [
                CohortRate(experience.design.name, cohort, len(robots), one)
                for one in learn(experience.design, seen, prior, each_robot=False)
            ]
    return found


class Comparisons(NamedTuple):
    """All comparisons of a look at a fleet, the least chance first, and what was not compared."""

    compared: list[Compared]
    too_few: int
    """Number of cohorts' failure modes with too few robots in the cohort or outside to tell."""
    never_failed: int
    """Number of failure modes that never failed in any robot, of which there is nothing to compare."""


def compare(designs: Sequence[Experience], prior: str | None = None) -> Comparisons:
    """Compare each cohort of a fleet with all other robots, failure mode by failure mode. Raises DataError.

    Robots of several designs are compared by what they have in common: modes of one path with the same clock and life.
    A robot whose cohort of a kind is not known, as of no stated site, is in no comparison of that kind.
    Of modes of unknown rate, whose robots have nothing beside which they are alike, no comparison is made.
    """
    lived: dict[tuple[str, str, str], list[tuple[Origin, Seen]]] = defaultdict(list)
    for experience in designs:
        for robot in experience.robots:
            for seen in robot.seen:
                if not seen.mode.unknown:
                    lived[_part_type(seen.mode)].append((robot.origin, seen))
    found: list[Compared] = []
    too_few = never_failed = 0
    for some in lived.values():
        if not any(seen.failures for _, seen in some):
            never_failed += 1
            continue
        mode = some[0][1].mode
        told = promised(mode, [seen for _, seen in some], prior)
        expected = told.by_rate.to_each(_STATED)[:, 0].tolist()
        for kind, name_of in KINDS.items():
            named = [name_of(origin) for origin, _ in some]
            known = [at for at, name in enumerate(named) if name is not None]
            names = [named[at] for at in known]
            asked = Promised(
                [told.failures[at] for at in known], told.by_rate.of(np.array(known, np.intp)), told.together
            )
            for cohort in sorted(set(filter(None, names))) if len(set(names)) > 1 else ():
                one = compare_cohort(asked, [name == cohort for name in names])
                if one is None:
                    too_few += 1
                    continue
                own = [(some[at][1], expected[at]) for at in known if named[at] == cohort]
                found.append(Compared(
                    mode.path, mode.clock, kind, cohort, len(own), sum(seen.exposure for seen, _ in own),
                    sum(by for _, by in own), one, 1.0,
                ))  # fmt: skip
    chances = adjusted([one.found.chance for one in found])
    judged = [one._replace(chance=chance) for one, chance in zip(found, chances, strict=True)]
    return Comparisons(sorted(judged, key=lambda one: one.found.chance), too_few, never_failed)


def _part_type(mode: FailureMode) -> tuple[str, str, str]:
    return mode.path, mode.clock, repr(mode.life)
