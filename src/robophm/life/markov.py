"""The life of a part that goes through states before it fails, some of which it may come back from.

H = −ln of the probability that no failed state was entered. Its state is not seen: the hazard at an age is that of a
part which has not failed yet, whichever state it is in. Probabilities are sums of products of what is never negative
(uniformisation, and the squares of what it gives), and means come by elimination without a subtraction, so that no
digit cancels, however far apart the rates of failure and repair are.

Sources: Jensen, Markoff chains as an aid in the study of Markoff processes, Skandinavisk Aktuarietidskrift 36 (1953);
Grassmann, Taksar and Heyman, Regenerative analysis and steady state distributions for Markov chains, Operations
Research 33 (1985).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import count
from numbers import Real
from typing import ClassVar, NamedTuple, Self, cast

import numpy as np

from robophm.core.errors import ModelError
from robophm.life.distribution import Array, LifeDistribution

MOST_STATES = 50
"""States beyond which a life is not worked out."""

Transitions = tuple[tuple[str, tuple[tuple[str, float], ...]], ...]
"""The states that a part works in, in order, each with the states that it may go to, and the rates."""

_HIGHEST, _LOWEST = 1023, -1074
"""Powers of two that are numbers."""


@dataclass(frozen=True)
class Markov(LifeDistribution):
    """Life that begins in the first of ``states`` and ends in any state that is none of them.

    ``states``: of each state that the part works in, by name, the rate [1/clock] of each transition from it, e.g.
    ``{"whole": {"worn": 2e-6}, "worn": {"whole": 0.01, "failed": 5e-5}}``. Raises ModelError where they make no life.
    """

    states: Transitions | Mapping[str, Mapping[str, float]]
    closed_form: ClassVar = False
    dimensions: ClassVar = {"states": -1}
    scale_parameter: ClassVar = None

    def __post_init__(self) -> None:
        """Check states and rates: ModelError where they do not make a life."""
        object.__setattr__(self, "states", _checked(self.states))

    def rescaled(self, factor: float) -> Self:
        """The same life where every age is ``factor`` times as large: each rate is that much lower."""
        return type(self)({name: {other: rate / factor for other, rate in to} for name, to in self._transitions})

    @property
    def _transitions(self) -> Transitions:
        return cast(Transitions, self.states)  # as checked

    @property
    def _chain(self) -> _Chain:
        return _chain_of(self._transitions)

    def _cumulative_hazard(self, x: Array) -> Array:
        return self._since(x)[1]

    def _hazard(self, x: Array) -> Array:
        rate: Array = self._since(x)[0] @ self._chain.leaving
        return rate

    def _increment(self, x: Array, d: Array) -> Array:
        x, d = np.broadcast_arrays(x, d)
        return self._since(d, self._since(x)[0])[1]

    def _since(self, duration: Array, shares: Array | None = None) -> tuple[Array, Array]:
        """The shares of states after some time, given that it has not failed, and by how much H has grown.

        ``shares``, shape (…, states), before that; without, it is new.
        """
        chain, shape = self._chain, np.shape(duration)
        left = np.ravel(np.asarray(duration, dtype=float)) / chain.step
        shares = chain.new(len(left)) if shares is None else shares.reshape(len(left), -1)
        grown = np.where(np.isposinf(left), np.inf, np.where(np.isnan(left), np.nan, 0.0))
        left = np.where(np.isfinite(left), left, 0.0)
        while (most := left.max(initial=0.0)) >= 1:
            level = int(np.frexp(most)[1]) - 1
            some = np.flatnonzero(left >= 2.0**level)
            shares[some], added = chain.jump(level).after(shares[some])
            grown[some] += added
            left[some] -= 2.0**level
        some = np.flatnonzero(left)
        shares[some], added = chain.short(shares[some], left[some])
        grown[some] += added
        return shares.reshape(*shape, -1), grown.reshape(shape)

    def _age_at(self, H: Array) -> Array:
        """Bit by bit: each power of two of a step that does not make H too large."""
        chain, shape = self._chain, np.shape(H)
        left = np.ravel(np.asarray(H, dtype=float)).copy()
        age: Array = np.where(np.isnan(left), np.nan, 0.0)
        shares = chain.new(len(left))
        left[~np.isfinite(left)] = 0.0
        level = next(
            k for k in count() if k == _HIGHEST or chain.jump(k).after(chain.new(1))[1][0] > left.max(initial=0)
        )
        while level > _LOWEST and (some := np.flatnonzero((left > 0) & (age < 2.0 ** min(level + 54, _HIGHEST)))).size:
            after, added = chain.jump(level).after(shares[some])
            fits = added <= left[some]
            taken = some[fits]
            shares[taken], age[taken] = after[fits], age[taken] + 2.0**level
            left[taken] -= added[fits]
            level -= 1
        age *= chain.step
        return age.reshape(shape)

    def _residual_moment(self, x: Array, order: int) -> Array:
        moment: Array = self._since(x)[0] @ self._chain.moments[order - 1]
        return moment


class _Jump(NamedTuple):
    """Some time in a chain, of which what stays is ``exp(log_scale)`` times ``stays``."""

    stays: Array
    log_scale: float
    fails: Array
    """The probability of a failure, by state."""

    def after(self, shares: Array) -> tuple[Array, Array]:
        """The shares of states after it, given that none has failed, and −ln of the probability of that."""
        with np.errstate(divide="ignore"):
            after, failed = shares @ self.stays, shares @ self.fails
            stayed = after.sum(axis=-1)
            grown = np.where(failed < 0.5, -np.log1p(-np.minimum(failed, 0.5)), -np.log(stayed) - self.log_scale)
        return after / stayed[:, None], grown

    def twice(self) -> _Jump:
        """Twice the time."""
        stays = self.stays @ self.stays
        fails = np.minimum(self.fails + np.exp(self.log_scale) * (self.stays @ self.fails), 1.0)
        return _Jump(stays, 2 * self.log_scale, fails).of_whole_rows()

    def of_whole_rows(self) -> _Jump:
        """The same where what stays and what fails is 1: else roundings, small beside 1, would grow to be failures."""
        scale = self.stays.max()
        stays, log_scale = self.stays / scale, self.log_scale + float(np.log(scale))
        with np.errstate(over="ignore", invalid="ignore"):
            whole = (1 - self.fails) * np.exp(-log_scale) / stays.sum(axis=1)
        return _Jump(stays * np.where(self.fails < 0.5, whole, 1.0)[:, None], log_scale, self.fails)


class _Chain:
    """A chain of states that work, and what is known of it so far."""

    def __init__(self, states: Transitions) -> None:
        names = [name for name, _ in states]
        self._rates = np.zeros((len(names), len(names)))
        self.leaving = np.zeros(len(names))
        """The rate of failure [1/clock], by state."""
        for i, (_, transitions) in enumerate(states):
            for name, rate in transitions:
                if name in names:
                    self._rates[i, names.index(name)] = rate
                else:
                    self.leaving[i] += rate
        out = self._rates.sum(axis=1) + self.leaving
        self.step = 2.0 ** -float(np.frexp(out.max())[1])
        """A power of two [clock] in which no state is left more than once on average."""
        moved = self._rates * self.step
        np.fill_diagonal(moved, 1 - out * self.step)
        self._once = np.column_stack([moved, self.leaving * self.step])
        self._jumps: dict[int, _Jump] = {}
        first = self._mean_times(np.ones(len(names)))
        self.moments = first, self._mean_times(2 * first)
        """Mean remaining life [clock] and mean of its square, by state."""

    def new(self, number: int) -> Array:
        """So many parts in the first state."""
        shares = np.zeros((number, len(self.leaving)))
        shares[:, 0] = 1.0
        return shares

    def jump(self, level: int) -> _Jump:
        """Two to this power of the step."""
        found = self._jumps.get(level)
        if found is None:
            found = self.jump(level - 1).twice() if level > 0 else self._short(2.0**level)
            self._jumps[level] = found
        return found

    def _short(self, part: float) -> _Jump:
        """A part, no more than all, of the step."""
        size = len(self.leaving)
        stays, fails = zip(*(self._terms(row[None], np.array([part])) for row in np.eye(size)), strict=True)
        return _Jump(np.concatenate(stays), 0.0, np.concatenate(fails)).of_whole_rows()

    def short(self, shares: Array, part: Array) -> tuple[Array, Array]:
        """As ``after`` of a jump, of another part of the step, less than all, for each row."""
        after, failed = self._terms(shares, part)
        stayed = after.sum(axis=-1)
        grown = np.where(failed < 0.5, -np.log1p(-np.minimum(failed, 0.5)), -np.log(np.maximum(stayed, 1e-300)))
        return after / stayed[:, None], grown

    def _terms(self, shares: Array, part: Array) -> tuple[Array, Array]:
        """What stays, by state, and what fails: the sum over how many jumps of a Poisson process there were.

        After so many as there are states the first failures have come, so that sixteen more give all digits of them.
        """
        size = len(self.leaving)
        weight = np.exp(-part)
        stays, fails = weight[:, None] * shares, np.zeros(len(shares))
        now, gone = shares, np.zeros(len(shares))
        for number in range(1, size + 20):
            weight = weight * part / number
            gone = gone + now @ self._once[:, -1]
            now = now @ self._once[:, :-1]
            stays = stays + weight[:, None] * now
            fails = fails + weight * gone
        return stays, fails

    def _mean_times(self, reward: Array) -> Array:
        """The mean of what is earned at these rates until the failure, by state; states leave one after the other."""
        rates, leaving, earned = self._rates.copy(), self.leaving.copy(), reward.copy()
        size = len(leaving)
        out = np.zeros(size)
        for k in range(size - 1, -1, -1):
            out[k] = rates[k, :k].sum() + leaving[k]
            share = rates[:k, k] / out[k]
            rates[:k, :k] += share[:, None] * rates[k, :k]
            leaving[:k] += share * leaving[k]
            earned[:k] += share * earned[k]
        means = np.zeros(size)
        for k in range(size):
            means[k] = (earned[k] + rates[k, :k] @ means[:k]) / out[k]
        return means


@lru_cache(maxsize=256)
def _chain_of(states: Transitions) -> _Chain:
    return _Chain(states)


def _checked(states: Transitions | Mapping[str, Mapping[str, float]]) -> Transitions:
    """States and transitions as tuples; ModelError where one is out of reach, or leads to no failure."""
    try:
        found = tuple((name, tuple(dict(to).items())) for name, to in dict(states).items())
    except (TypeError, ValueError):
        found = ()
    if not found or len(found) > MOST_STATES or not all(isinstance(name, str) for name, _ in found):
        expected = "of each the rates to others, e.g. {whole: {worn: 2e-6}, worn: {whole: 0.01, failed: 5e-5}}"
        raise ModelError(f"Markov: states = {str(states)[:80]}, expected at most {MOST_STATES} states, {expected}")
    for name, transitions in found:
        for other, rate in transitions:
            number = isinstance(rate, Real) and not isinstance(rate, bool) and 0 < rate < np.inf
            if not number or other == name or not isinstance(other, str):
                expected = "a finite rate > 0 to another state"
                raise ModelError(f"Markov: from '{name}' to '{other}' the rate is {rate!r}, expected {expected}")
    names = [name for name, _ in found]
    reached, fail = {names[0]}, {other for _, to in found for other, _ in to if other not in names}
    for _ in names:
        reached |= {other for name, to in found if name in reached for other, _ in to}
        fail |= {name for name, to in found if any(other in fail for other, _ in to)}
    for name in names:
        if name not in reached:
            raise ModelError(f"Markov: nothing leads from '{names[0]}' to '{name}', expected a way to each state")
        if name not in fail:
            raise ModelError(f"Markov: nothing fails from '{name}' on, expected a way to a state with nothing from it")
    return tuple((name, tuple((other, float(rate)) for other, rate in to)) for name, to in found)
