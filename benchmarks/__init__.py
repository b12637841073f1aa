"""Speed as a ratio against a named peer: both in one run on one machine, their answers compared first.

One file is one room, one decorated function is one benchmark; it first agrees with its peer, then races it.

>>> @benchmark                                                    # doctest: +SKIP
... def sums() -> Iterator[Line]:
...     agree("sum", ours(), peer(), 1e-12)
...     yield Line("a million numbers", *race(ours, peer), "NumPy")
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

ROOMS = (
    "blocks",
    "monte_carlo",
    "health",
    "wear",
    "fleets",
    "life",
    "hazard",
    "design",
    "transports",
    "virtual_life",
    "measured",
    "package",
)


class DisagreementError(Exception):
    """Ours and the peer answer differently: a ratio of their times would mean nothing."""


@dataclass(frozen=True)
class Line:
    """One row of the table; times in seconds, ratio = ours / peer, below 1 where ours is faster."""

    work: str
    ours: float
    peer: float | None = None
    peer_name: str = ""
    goal: float | None = None
    """Highest ratio that is good enough, where one was set."""
    per_second: str = ""
    """How much ours does in a second."""

    @property
    def ratio(self) -> float | None:
        return self.ours / self.peer if self.peer else None


BENCHMARKS: dict[str, Callable[[], Iterator[Line]]] = {}
"""By room and name, ``life.hazard``, in the order in which they run."""


def benchmark(function: Callable[[], Iterator[Line]]) -> Callable[[], Iterator[Line]]:
    BENCHMARKS[f"{function.__module__.rpartition('.')[2]}.{function.__name__}"] = function
    return function


def agree(what: str, ours: Any, peer: Any, tolerance: float) -> None:
    """Raise DisagreementError where two answers differ by more than ``tolerance``, relative to the peer's."""
    ours, peer = np.asarray(ours, dtype=float), np.asarray(peer, dtype=float)
    if ours.shape != peer.shape:
        raise DisagreementError(f"{what}: shape {ours.shape}, the peer's is {peer.shape}")
    if not np.all(np.isfinite(ours) & np.isfinite(peer)):
        raise DisagreementError(f"{what}: an answer is not finite")
    off = np.abs(ours - peer) / np.maximum(np.abs(peer), np.finfo(float).tiny)
    off = np.where(ours == peer, 0.0, off)
    if ours.size and off.max() > tolerance:
        i = np.unravel_index(int(off.argmax()), off.shape)
        raise DisagreementError(f"{what}: {ours[i]!r}, the peer says {peer[i]!r}; expected them within {tolerance:g}")


def seconds(value: float | None) -> str:
    """A time as people read it: "1.2 s", "35 ms", "4.4 µs"."""
    if value is None:
        return ""
    scale, unit = next((s, u) for s, u in ((1, "s"), (1e-3, "ms"), (1e-6, "µs")) if value >= s or s == 1e-6)
    return f"{value / scale:.3g} {unit}"


def race(*runners: Callable[[], Any], rounds: int = 15, at_least: float = 0.02) -> list[float]:
    """Best time of each [s], taking turns so that a slow moment of the machine hits all alike.

    What is quicker than ``at_least`` [s] is repeated within a round, so that the clock's step does not count.
    """
    times = []
    for run in runners:
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    repeats = [max(1, round(at_least / seconds)) for seconds in times]
    best = [float("inf")] * len(runners)
    for _ in range(rounds):
        for i, run in enumerate(runners):
            start = time.perf_counter()
            for _ in range(repeats[i]):
                run()
            best[i] = min(best[i], (time.perf_counter() - start) / repeats[i])
    return best
