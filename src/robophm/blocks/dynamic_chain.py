"""The states of a dynamic fault tree as a Markov chain: the probability of its top event at times, and its mean time.

By uniformisation (Jensen 1953): positive terms alone, so that the smallest probability has all its digits. Nothing is
repaired, so that no state comes again, and the mean time follows from one state after the other.
"""

from __future__ import annotations

import math
import time as clock

import numpy as np
from numpy.typing import NDArray

from robophm.blocks.dynamic_tree import END, DynamicTree, State
from robophm.core.errors import StructureError

Array = NDArray[np.float64]

MOST_STATES = 300_000
"""The most states of a chain."""

MOST_STEPS = 500_000
"""The most steps of uniformisation: events of the fastest state in the longest time."""

_EXACT = 1e-13


class DynamicChain:
    """The chain of a dynamic tree.

    Raises StructureError beyond ``most`` states, where the order of failures at one moment decides, or until then
    (``time.perf_counter()``).
    """

    def __init__(self, tree: DynamicTree, until: float = math.inf, most: int = MOST_STATES) -> None:
        self._until = until
        explorer = tree.explorer()
        number: dict[State, int] = {END: 0}
        todo: list[State] = []

        def known(state: State) -> int:
            if state not in number:
                number[state] = len(number)
                todo.append(state)
                if len(number) > most or clock.perf_counter() > until:
                    raise StructureError(
                        f"dynamic fault tree: too many states to solve exactly, more than {len(number) - 1:,}"
                    )
            return number[state]

        self._first = [(chance, known(state)) for chance, state in explorer.first()]
        starts, ends, rates = [], [], []
        while todo:
            state = todo.pop()
            start = number[state]
            for rate, leads in explorer.onward(state):
                for chance, end in leads:
                    starts.append(start)
                    ends.append(known(end))
                    rates.append(rate * chance)
        self.states = len(number)
        """Number of states, with the one in which the top event has occurred."""
        self._starts, self._ends, self._rates = np.array(starts, int), np.array(ends, int), np.array(rates, float)

    def probability(self, time: float) -> float:
        """Return P(top event by a time), in the unit of the rates. Raises StructureError where it takes too long."""
        from scipy.sparse import csr_array

        begin = np.zeros(self.states)
        for chance, state in self._first:
            begin[state] += chance
        stays = self._starts != self._ends
        starts, ends, rates = self._starts[stays], self._ends[stays], self._rates[stays]
        out = np.bincount(starts, rates, self.states)
        fastest = float(out.max(initial=0.0))
        events = fastest * time
        if not events:
            return float(begin[0])
        if events > MOST_STEPS:
            raise StructureError(
                f"dynamic fault tree: {events:.3g} failures of the fastest state until then; expected at most "
                f"{MOST_STEPS:,}"
            )
        step = csr_array((rates / fastest, (ends, starts)), shape=(self.states, self.states))
        stay = 1.0 - out / fastest
        stay[stay < 4e-16 * self.states] = 0.0
        now, total, weight, left = begin, 0.0, -events, 1.0  # weight: its logarithm
        k = 0
        while True:
            share = math.exp(weight)
            total += share * float(now[0])
            left -= share
            if (k > events and share * k < _EXACT * max(total, 1e-290)) or k > events + 50 * math.sqrt(events) + 400:
                return min(total + max(left, 0.0) * float(now[0]) * (left > 1e-12), 1.0)
            if clock.perf_counter() > self._until:
                raise StructureError(
                    f"dynamic fault tree: too long to solve exactly: {k:,} of {events:,.0f} steps in this time"
                )
            now = step @ now + stay * now
            k += 1
            weight += math.log(events / k)

    def mean_time(self) -> float:
        """Return the mean time to the top event; infinite where it may never occur."""
        leads: list[list[tuple[int, float]]] = [[] for _ in range(self.states)]
        for start, end, rate in zip(self._starts.tolist(), self._ends.tolist(), self._rates.tolist(), strict=True):
            if start != end:
                leads[start].append((end, rate))
        mean = {0: 0.0}
        todo = [state for _, state in self._first]
        while todo:
            state = todo[-1]
            missing = [end for end, _ in leads[state] if end not in mean] if state not in mean else []
            if missing:
                todo += missing
                continue
            todo.pop()
            if state not in mean:
                out = math.fsum(rate for _, rate in leads[state])
                mean[state] = (1 + math.fsum(rate * mean[end] for end, rate in leads[state])) / out if out else math.inf
        return math.fsum(chance * mean[state] for chance, state in self._first)
