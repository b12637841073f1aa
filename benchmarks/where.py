"""Where the time of the engine goes: ``python -m benchmarks.where [WORK ...]``; no peer is needed.

Of each work: its time, how often it calls a function of NumPy by name (operators and methods come on top), and what
its elementary functions (exp, expm1, log, log1p, power) take when the same arrays are given to them bare. That is the
least that the work can take by them on this machine; the rest is arithmetic, copies and the calls themselves.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from benchmarks import race
from benchmarks.designs import MISSION, ages, robot_of
from robophm.core.waiting_time import time_at
from robophm.health.fleet import Fleet
from robophm.health.outlooks import as_designed, nominal_outlook
from robophm.health.plant import Plant

ELEMENTARY = frozenset({"exp", "expm1", "log", "log1p", "power"})
Work = Callable[[], object]


def tick(parts: int, ask: str) -> Work:
    plant, age = Plant(robot_of(parts)), ages(parts, 99)[:, None]
    diagram, hours = plant.robot.diagram, (MISSION,) if ask == "ahead" else ()
    return lambda: getattr(Fleet.designed(plant, age), ask)(diagram, *hours)


def quantiles() -> Work:
    plant, age, survives = Plant(robot_of(100)), ages(100, 7), np.array([0.95, 0.5, 0.05])
    return lambda: time_at(nominal_outlook(plant, age).curve(plant.robot.diagram), 1 - survives, survives)


def mean() -> Work:
    plant, age = Plant(robot_of(100)), ages(100, 7)
    return lambda: nominal_outlook(plant, age).mean_remaining_life(plant.robot.diagram)


def curve() -> Work:
    plant, age, hours = Plant(robot_of(10_000)), ages(10_000, 5), np.linspace(1.0, 640.0, 64)
    return lambda: nominal_outlook(plant, age).curve(plant.robot.diagram)(hours)


def since_new() -> Work:
    plant, hours = Plant(robot_of(10_000, ageing=True)), np.linspace(1.0, 2000.0, 120)
    outlook = as_designed(plant)
    return lambda: outlook.reliability_curve(plant.robot.diagram, hours)


def robots() -> Work:
    plant, age = Plant(robot_of(100)), np.random.default_rng(11).uniform(100.0, 3000.0, (100, 10_000))
    return lambda: Fleet.designed(plant, age).ahead(plant.robot.diagram, MISSION)


WORKS: dict[str, Callable[[], Work]] = {
    "tick-100": partial(tick, 100, "ahead"),
    "hazard-100": partial(tick, 100, "hazard_rate"),
    "new-100": partial(tick, 100, "since_new"),
    "tick-10000": partial(tick, 10_000, "ahead"),
    "hazard-10000": partial(tick, 10_000, "hazard_rate"),
    "new-10000": partial(tick, 10_000, "since_new"),
    "quantiles-100": quantiles,
    "mean-100": mean,
    "curve-10000": curve,
    "times-10000": since_new,
    "robots-10000": robots,
}


class Noted:
    """A function of NumPy that notes when it is called by name, and an elementary one with its arrays."""

    def __init__(self, name: str, names: list[str], calls: list[Work]) -> None:
        self._function, self._name, self._names, self._calls = getattr(np, name), name, names, calls

    def __call__(self, *arrays: Any, **options: Any) -> Any:
        self._names.append(self._name)
        if self._name in ELEMENTARY:
            given = [np.array(one) for one in arrays[: self._function.nin]]
            where = {"where": np.array(options["where"])} if "where" in options else {}
            shape = np.broadcast(*given, *where.values()).shape
            self._calls.append(partial(self._function, *given, np.empty(shape), **where))
        return self._function(*arrays, **options)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._function, name)


@contextmanager
def noted(names: list[str], calls: list[Work]) -> Iterator[None]:
    own = {name: one for name in dir(np) if isinstance(one := getattr(np, name), np.ufunc)}
    for name in own:
        setattr(np, name, Noted(name, names, calls))
    try:
        yield
    finally:
        for name, function in own.items():
            setattr(np, name, function)


def _all(calls: list[Work]) -> None:
    with np.errstate(all="ignore"):
        for call in calls:
            call()


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.where", description=__doc__)
    parser.add_argument("works", nargs="*", metavar="WORK", help=f"default all: {', '.join(WORKS)}")
    wanted = parser.parse_args().works or list(WORKS)
    if unknown := [name for name in wanted if name not in WORKS]:
        parser.error(f"no work {unknown[0]!r}; expected {', '.join(WORKS)}")
    print(f"{'work':14}{'time':>12}{'calls by name':>16}{'elementary':>12}{'bare':>12}{'share':>8}")
    for name in wanted:
        names: list[str] = []
        calls: list[Work] = []
        with noted(names, calls):
            work = WORKS[name]()
            work()  # what is prepared once
            names.clear()
            calls.clear()
            work()
        work = WORKS[name]()
        work()
        ours, bare = race(work, partial(_all, calls), rounds=9)
        print(
            f"{name:14}{ours * 1e6:9,.0f} µs{len(names):16,}{len(calls):12,}{bare * 1e6:9,.0f} µs{bare / ours:8.0%}",
            flush=True,
        )


if __name__ == "__main__":
    main()
