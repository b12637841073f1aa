"""Simulation of robots that age, fail, are found to have failed and are repaired: many at once, by events.

Every part draws its life once, when it is new: the age at which it fails. In a leg everything is constant, so ages
grow in proportion to time and a failure's moment is computed, not stepped to. Times are seconds from the start.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.simulation.design import CLOCKS, Design, Stress
from robophm.simulation.lives import Life
from robophm.simulation.plan import JITTER, MOST_LEGS, Plans, within
from robophm.simulation.structure import fails_at, parts_of

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Index = npt.NDArray[np.int64]

HORIZON = 7e9
"""Seconds, some two hundred years: a robot that outlives them is not followed further."""

_EXACT = 256
"""Rounds in which a mode whose hazard is scaled is followed piece by piece."""

FAILED, REPLACED, INSPECTED, END = range(4)
"""Events of a part, or of a robot."""

ROBOT = -1
"""Instead of a part's number: the robot as a whole."""

NO_MODE = -1
"""Instead of the number of a failure mode: what did not fail."""


class Events(NamedTuple):
    """Things of one kind that happened to robots and their parts; arrays of one length."""

    robots: Index
    parts: Index
    modes: Index
    """Failure mode by which each part failed; NO_MODE where it did not, and for a robot as a whole."""
    times: Array
    what: int


@dataclass(frozen=True)
class Piece:
    """A stretch of time in which nothing changes, for each robot."""

    begin: Array
    end: Array
    speed: Array
    stress: Array
    """Readings of the sensors, shape (robots, signals)."""


@dataclass
class Lives:
    """The lives of some robots: when each part and each robot failed."""

    pieces: list[Piece] = field(default_factory=list)
    """Stretches of time when they were on, in order of time; some may be empty."""
    done: list[Flags] = field(default_factory=list)
    """Flags for each task, whether each robot did it: the rounds of some have more tasks than those of others."""
    starts: list[Array] = field(default_factory=list)
    ends: list[Array] = field(default_factory=list)
    failed: list[Flags] = field(default_factory=list)
    """Whether each task failed."""
    slots: list[Index] = field(default_factory=list)
    """Index, in its list, of the task that each robot did."""
    refused: int = 0
    """Starts before which a robot had to be repaired."""
    end: Array = field(default_factory=lambda: np.empty(0))
    """Time when the record of each robot ends."""
    events: list[Events] = field(default_factory=list)


def live(design: Design, plans: Plans, tasks: int, rng: np.random.Generator, *, uncertain_rates: bool = False,
         jitter: float = 1.0) -> Lives:  # fmt: skip
    """Let robots do so many tasks each, in whole rounds; then to the next failure by the plan, without repair."""
    return _Robots(design, plans, rng, uncertain_rates, jitter).live(tasks)


class _Robots:
    def __init__(self, design: Design, plans: Plans, rng: np.random.Generator, uncertain: bool, jitter: float) -> None:
        self.design, self.plans, self.rng, self.jitter = design, plans, rng, jitter
        modes = design.modes
        self.count = len(plans.every)
        self.every_robot = np.arange(self.count)
        shape = (self.count, len(modes))
        self.part: Index = np.array([mode.part for mode in modes])
        self.first: Index = np.searchsorted(self.part, np.arange(len(design.parts)))
        self.clock = np.array([list(CLOCKS).index(mode.clock) for mode in modes])
        self.duty = np.array([1.0 if mode.clock == "calendar" else mode.duty for mode in modes])
        self.hazard_scaled = [m for m, mode in enumerate(modes) if mode.by_hazard]
        self.lives: dict[Life, list[int]] = defaultdict(list)
        for m, mode in enumerate(modes):
            self.lives[mode.life].append(m)
        self.stressed: dict[tuple[Stress, ...], list[int]] = defaultdict(list)
        for m, mode in enumerate(modes):
            if mode.stresses:
                self.stressed[mode.stresses].append(m)
        blocks = [*design.functions.values(), design.whole]
        self.members = np.zeros((len(blocks), len(design.parts)), dtype=bool)
        for f, block in enumerate(blocks):
            self.members[f, sorted(parts_of(block))] = True
        self.mean = 1 / (np.array([mode.rate for mode in modes]) * self._rate_factors(uncertain))
        self.age = np.zeros(shape)
        """Age of each mode on its own clock; as stressed, where stress scales its age."""
        self.limit = np.zeros(shape)
        """Age at which each mode fails; its Exp(1) draw, where stress scales its hazard."""
        self.spent = np.zeros(shape)
        """Cumulative hazard so far of the modes whose hazard is scaled."""
        self.fails = np.full((self.count, len(design.parts)), np.inf)
        """Time when each part failed; infinite while it works."""
        self.failed_by: Index = np.zeros(self.fails.shape, dtype=np.int64)
        """Failure mode by which each part failed, where it has."""
        self.system_down = np.zeros(self.count, dtype=bool)
        self.now = np.zeros(self.count)
        self.result = Lives()
        self._renew(np.ones((self.count, len(design.parts)), dtype=bool), np.array([mode.initial for mode in modes]))

    def _rate_factors(self, uncertain: bool) -> Array:
        """The true rates of each robot as multiples of the stated ones; modes of one origin share one unknown."""
        factors = np.ones((self.count, len(self.design.modes)))
        drawn: dict[tuple[str, object], Array] = {}
        for m, mode in enumerate(self.design.modes):
            if not uncertain or mode.uncertainty is None:
                continue
            kind, values = mode.uncertainty
            key = (mode.origin, None if kind == "error_factor" else mode.uncertainty)
            if key not in drawn:
                if kind == "error_factor":
                    drawn[key] = self.rng.standard_normal(self.count)
                elif kind == "failures":
                    drawn[key] = self.rng.gamma(values[0], 1 / values[0], self.count)
                else:
                    drawn[key] = self.rng.choice(np.array(values), self.count)
            factors[:, m] = drawn[key]
            if kind == "error_factor":  # 95th percentile / median = exp(1.645 σ); the mean is 1
                sigma = np.log(values[0]) / 1.6448536269514722
                factors[:, m] = np.exp(sigma * drawn[key] - sigma**2 / 2)
        return factors

    def _renew(self, parts: Flags, ages: Array) -> None:
        """New parts, shape (robots, parts), of the given ages, shape (modes,), each with a life of its own."""
        draws = self.rng.standard_exponential(self.age.shape)
        new = parts[:, self.part]
        for life, modes in self.lives.items():
            # Only what is renewed is computed: most robots most of the time need nothing.
            robots, which = np.nonzero(new[:, modes])
            at = robots, np.array(modes)[which]
            mean = self.mean[at]
            self.limit[at] = life.age_at(life.log_survival(ages[at[1]], mean) - draws[at], mean)
        for m in self.hazard_scaled:
            self.limit[new[:, m], m] = draws[new[:, m], m]
        self.spent[new] = 0.0
        self.age = np.where(new, ages, self.age)
        self.fails[parts] = np.inf

    # Ageing.

    def _clocks(self, hours: Array, speed: Array, needed: Flags) -> Array:
        """The advance of each mode's clock in a leg that needs these parts, shape (robots, modes)."""
        usage = self.design.usage
        per_hour = (1.0, 1.0, speed * 3.6, usage.get("cycles", 0.0), usage.get("starts", 0.0))  # as CLOCKS names them
        gone = np.stack([hours * each for each in per_hour], axis=1)
        return gone[:, self.clock] * np.where(needed[:, self.part], 1.0, self.duty)

    def _clocks_off(self, hours: Array) -> Array:
        """The same while the robot is off: only the calendar goes on."""
        return np.where(self.clock == list(CLOCKS).index("calendar"), hours[:, None], 0.0)

    def _factors(self, stress: Array) -> Array:
        """ψ of each mode, shape (robots, modes)."""
        factors = np.ones((self.count, len(self.part)))
        for stresses, modes in self.stressed.items():
            factor = np.ones(self.count)
            for one in stresses:
                factor = factor * one.factor(stress[:, one.signal])
            factors[:, modes] = factor[:, None]
        return factors

    def _when(self, clocks: Array, factors: Array) -> tuple[Array, Index]:
        """The share of the stretch at which each part fails, shape (robots, parts), and by which of its modes.

        Infinite: later, and the mode says nothing.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (self.limit - self.age) / (clocks * factors)
            for m in self.hazard_scaled:
                life, mean = self.design.modes[m].life, self.mean[:, m]
                left = (self.limit[:, m] - self.spent[:, m]) / factors[:, m]
                reached = life.age_at(life.log_survival(self.age[:, m], mean) - left, mean)
                share[:, m] = (reached - self.age[:, m]) / clocks[:, m]
            share = np.where((clocks > 0) & (share <= 1), np.maximum(share, 0.0), np.inf)
        first: Array = np.minimum.reduceat(share, self.first, axis=1)
        modes = np.where(share == first[:, self.part], np.arange(len(self.part)), len(self.part))
        return first, np.minimum.reduceat(modes, self.first, axis=1)

    def _pass(
        self, begin: Array, length: Array, clocks: Array, factors: Array, share: Array, failing_at: tuple[Array, Index]
    ) -> None:
        """Let a share of the stretch happen, shape (robots,): parts age and fail, and so may robots."""
        when, by = failing_at
        failing = np.isinf(self.fails) & (when <= share[:, None])
        robots, parts = np.nonzero(failing)
        times = begin[robots] + when[robots, parts] * length[robots]
        self.fails[robots, parts] = times
        self.failed_by[robots, parts] = by[robots, parts]
        self.result.events.append(Events(robots, parts, by[robots, parts], times, FAILED))
        clocks = clocks * share[:, None]
        gained = clocks * factors
        for m in self.hazard_scaled:
            life, mean, age = self.design.modes[m].life, self.mean[:, m], self.age[:, m]
            increment = life.log_survival(age, mean) - life.log_survival(age + clocks[:, m], mean)
            self.spent[:, m] += factors[:, m] * increment
            gained[:, m] = clocks[:, m]  # its age is that of its clock
        self.age += gained
        self.now = begin + share * length
        system = fails_at(self.design.whole, self.fails)
        down = np.isfinite(system) & ~self.system_down
        self.system_down |= down
        self._note(down, system, FAILED)

    def _note(self, robots: Flags, times: Array, what: int) -> None:
        """Something happened to these robots as a whole."""
        found = np.flatnonzero(robots)
        self.result.events.append(
            Events(found, np.full_like(found, ROBOT), np.full_like(found, NO_MODE), times[robots], what)
        )

    def _repair(self, robots: Flags) -> None:
        """Every failed part of these robots is replaced now, every other one inspected."""
        failed = np.isfinite(self.fails)
        for parts, what in ((failed, REPLACED), (~failed, INSPECTED)):
            b, u = np.nonzero(parts & robots[:, None])
            modes = self.failed_by[b, u] if what == REPLACED else np.full_like(b, NO_MODE)
            self.result.events.append(Events(b, u, modes, self.now[b], what))
        self._renew(failed & robots[:, None], np.zeros(len(self.part)))
        self.system_down &= ~robots

    def _needed(self, functions: Flags) -> Flags:
        """Whether each part is in any of these functions, shape (robots, parts)."""
        needed: Flags = functions @ self.members
        return needed

    def _functions_fail(self, parts: Array) -> Array:
        """The times when functions fail if parts fail then; shape (robots, functions), the last is the robot."""
        blocks = (*self.design.functions.values(), self.design.whole)
        return np.stack([fails_at(block, parts) for block in blocks], axis=1)

    # What they do.

    def live(self, tasks: int) -> Lives:
        """Return the record, and what follows up to the next failure."""
        used = np.array(sorted({mode.part for mode in self.design.modes if mode.initial > 0}), dtype=int)
        robots, parts = (one.ravel() for one in np.meshgrid(self.every_robot, used, indexing="ij"))
        survived = np.full_like(robots, NO_MODE)
        self.result.events.append(Events(robots, parts, survived, self.now[robots], INSPECTED))  # each its past
        rounds = -(-tasks // self.plans.tasks)  # what is begun is finished
        for number in range(int(np.max(rounds * self.plans.tasks))):
            self._task(number, number < rounds * self.plans.tasks)
        self._rest(rounds * self.plans.every)  # the next round begins
        down = np.isfinite(self._functions_fail(self.fails)[:, -1])
        self._repair(down)
        self.result.end = self.now.copy()
        self._note(np.ones(self.count, dtype=bool), self.now, END)
        system = self._next_failure()
        self._note(system < HORIZON, system, FAILED)
        return self.result

    def _rest(self, until: Array) -> None:
        """Let robots rest, switched off: only the calendar goes on."""
        length = until - self.now
        clocks = self._clocks_off(length / 3600)
        factors = np.ones(clocks.shape)
        self._pass(self.now, length, clocks, factors, np.ones(self.count), self._when(clocks, factors))
        self.now = until

    def _task(self, number: int, doing: Flags) -> None:
        """Let the robots that do it perform one task."""
        plans, every = self.plans, self.every_robot
        rounds, slot = number // plans.tasks, number % plans.tasks
        before = np.where(np.arange(plans.seconds.shape[1]) < slot[:, None], plans.seconds.sum(axis=2), 0.0).sum(axis=1)
        self._rest(np.where(doing, rounds * plans.every + before, self.now))
        start = self.now
        needs = plans.needs[every, slot] & (plans.seconds[every, slot] > 0)[..., None] & doing[:, None, None]
        broken: Flags = np.any(np.isfinite(self._functions_fail(self.fails)) & needs.any(axis=1), axis=1)
        self.result.refused += int(broken.sum())
        self._repair(broken)
        failed = np.zeros(self.count, dtype=bool)
        for leg in range(MOST_LEGS):
            failed |= self._leg(slot, leg, needs[:, leg], doing & ~failed)
        self.result.done.append(doing)
        self.result.starts.append(start)
        self.result.ends.append(self.now)
        self.result.failed.append(failed)
        self.result.slots.append(slot)
        self._repair(failed)

    def _leg(self, slot: Index, leg: int, needs: Flags, doing: Flags) -> Flags:
        """Let robots perform one leg, up to where a function that it needs fails; return whose fails."""
        plans, every = self.plans, self.every_robot
        length = np.where(doing, plans.seconds[every, slot, leg], 0.0)
        speed = plans.speed[every, slot, leg]
        stress = self._jittered(plans.stress[every, slot, leg])
        clocks = self._clocks(length / 3600, speed, self._needed(needs))
        factors = self._factors(stress)
        failing_at = self._when(clocks, factors)
        functions = self._functions_fail(np.where(np.isfinite(self.fails), 0.0, failing_at[0]))  # in shares of this leg
        first = np.where(needs, functions, np.inf).min(axis=1)
        fails = np.isfinite(first) & (length > 0)
        begin = self.now
        self._pass(begin, length, clocks, factors, np.where(fails, first, 1.0), failing_at)
        self.result.pieces.append(Piece(begin, self.now, speed, stress))
        return np.asarray(fails)

    def _jittered(self, stress: Array) -> Array:
        """The readings of sensors when a leg is done: about what was planned."""
        result = stress.copy()
        for i, signal in enumerate(self.design.signals):
            off = self.rng.uniform(-1, 1, self.count) * JITTER[signal.input] * self.jitter
            if signal.input == "voltage":
                off = off * np.abs(stress[:, i])
            result[:, i] = within(signal, stress[:, i] + off)
        return result

    # The next failure, by the plan alone.

    def _next_failure(self) -> Array:
        """The time when each robot fails next if it repeats its plan without jitter and repair."""
        plans = self.plans
        legs = list(np.ndindex(plans.seconds.shape[1:]))
        lengths = [plans.seconds[:, task, leg] for task, leg in legs]
        clocks = [
            self._clocks(
                plans.seconds[:, task, leg] / 3600, plans.speed[:, task, leg], self._needed(plans.needs[:, task, leg])
            )
            for task, leg in legs
        ]
        factors = [self._factors(plans.stress[:, task, leg]) for task, leg in legs]
        rest = plans.every - np.sum(lengths, axis=0)
        lengths.append(rest)
        clocks.append(self._clocks_off(rest / 3600))
        factors.append(np.ones(clocks[0].shape))
        begins = np.cumsum([np.zeros(self.count), *lengths[:-1]], axis=0).T  # robots, pieces
        length, clock, factor = np.stack(lengths, axis=1), np.stack(clocks, axis=1), np.stack(factors, axis=1)
        gained = np.cumsum(clock * factor, axis=1)
        left = np.maximum(self.limit - self.age, 0.0)
        early: dict[int, Array] = {}
        for m in self.hazard_scaled:
            early[m], rounds = self._by_hazard(m, begins, length, clock[:, :, m], factor[:, :, m])
            left[:, m] = rounds * gained[:, -1, m]
        times = self._by_age(begins, length, gained, left)
        for m, exact in early.items():
            times[:, m] = np.where(np.isfinite(exact), exact, times[:, m])
        broken = np.isfinite(self.fails)
        fails: Array = np.where(broken, self.fails, np.minimum.reduceat(times, self.first, axis=1))
        return fails_at(self.design.whole, fails)

    def _by_age(self, begins: Array, length: Array, gained: Array, left: Array) -> Array:
        """The time when each mode has gained what was left to it, shape (robots, modes), from gains by piece."""
        a_round = gained[:, -1]
        with np.errstate(divide="ignore", invalid="ignore"):
            rounds = np.floor(left / a_round)
            left = np.clip(left - rounds * a_round, 0.0, a_round)
            piece = np.minimum((gained < left[:, None]).sum(axis=1), gained.shape[1] - 1)
            b, m = np.indices(piece.shape)
            before = np.where(piece > 0, gained[b, piece - 1, m], 0.0)
            share = (left - before) / (gained[b, piece, m] - before)
            share = np.where(np.isfinite(share), share, 0.0)
            into = begins[b, piece] + share * length[b, piece]
            times = self.now[:, None] + rounds * self.plans.every[:, None] + into
        return np.where(a_round > 0, times, np.inf)

    def _by_hazard(self, m: int, begins: Array, length: Array, clock: Array, factor: Array) -> tuple[Array, Array]:
        """The time when a mode whose hazard is scaled fails, shape (robots,): in the first rounds; else the later
        round.

        The first rounds are exact, piece by piece. Later h hardly changes within one, and a round adds its mean ψ
        times the increment of H over it, taken about where the round's hazard is centred (error ~ 1/rounds²).
        """
        life = self.design.modes[m].life
        edges = np.concatenate((np.zeros((self.count, 1)), np.cumsum(clock, axis=1)), axis=1)
        a_round = edges[:, -1]
        ages = self.age[:, m, None, None] + edges[:, None] + np.arange(_EXACT)[:, None] * a_round[:, None, None]
        steps = -np.diff(life.log_survival(ages, self.mean[:, m, None, None]), axis=2) * factor[:, None]
        total = np.cumsum(steps.reshape(self.count, -1), axis=1)
        left, mean, every_robot = self.limit[:, m] - self.spent[:, m], self.mean[:, m], self.every_robot
        index = (total < left[:, None]).sum(axis=1)
        late = index == total.shape[1]
        index = np.minimum(index, total.shape[1] - 1)
        turn, piece = np.divmod(index, clock.shape[1])
        with np.errstate(divide="ignore", invalid="ignore"):
            rest = left - np.where(index > 0, total[every_robot, index - 1], 0.0)
            age = ages[every_robot, turn, piece]
            reached = life.age_at(life.log_survival(age, mean) - rest / factor[every_robot, piece], mean)
            share = np.clip((reached - age) / clock[every_robot, piece], 0.0, 1.0)
            into = begins[every_robot, piece] + share * length[every_robot, piece]
            exact = np.where(late, np.inf, self.now + turn * self.plans.every + into)
            weight = clock * factor
            off = (weight * (edges[:, 1:] + edges[:, :-1])).sum(axis=1) / weight.sum(axis=1) / 2 - a_round / 2
            begun = self.age[:, m] + _EXACT * a_round + off
            mean_factor = weight.sum(axis=1) / a_round
            reached = life.age_at(life.log_survival(begun, mean) - (left - total[:, -1]) / mean_factor, mean)
            rounds = _EXACT + (reached - begun) / a_round
        return exact, np.where(late & (a_round > 0), rounds, 0.0)
