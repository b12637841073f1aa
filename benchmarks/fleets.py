"""Ticks, curves and fleets: thousands of parts, times and robots, against RePyability's calls that take the same."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks import Line, agree, benchmark, race
from benchmarks.designs import MISSION, ages, twins
from robophm.health.fleet import Fleet
from robophm.health.outlooks import as_designed, nominal_outlook
from robophm.health.plant import Plant

PEER = "RePyability"


def tick(parts: int, rounds: int, goal: float) -> Iterator[Line]:
    """Every part has a new age."""
    twin = twins(parts)
    plant, diagram = Plant(twin.robot), twin.robot.diagram

    def fleet(age: np.ndarray) -> Fleet:
        return Fleet.designed(plant, age[:, None])

    def ours(age: np.ndarray) -> float:
        return float(fleet(age).ahead(diagram, MISSION)[1][0])

    def theirs(age: np.ndarray) -> float:
        return float(twin.rbd.sf_given_state(MISSION, twin.state(age)))

    def our_hazard(age: np.ndarray) -> float:
        return float(fleet(age).hazard_rate(diagram)[0])

    def their_hazard(age: np.ndarray) -> float:
        now = twin.state(age)
        weight = twin.rbd.importances_given_state(0.0, now)["birnbaum"]
        return sum(weight[name] * float(np.squeeze(twin.models[name].hf(now[name]))) for name in twin.names)

    def our_past(age: np.ndarray) -> float:
        return float(fleet(age).since_new(diagram).works[0])

    def their_past(age: np.ndarray) -> float:
        return float(twin.system([twin.models[name].sf(one) for name, one in zip(twin.names, age, strict=True)])[0])

    for moment in range(3):
        age = ages(parts, moment)
        agree(f"next {MISSION} h of {parts} parts", ours(age), theirs(age), 1e-9)
        agree(f"hazard rate of {parts} parts", our_hazard(age), their_hazard(age), 1e-9)
        agree(f"reliability of {parts} parts", our_past(age), their_past(age), 1e-9)
    age = ages(parts, 99)
    runners = [lambda one=one: one(age) for one in (ours, theirs, our_hazard, their_hazard, our_past, their_past)]
    times = race(*runners, rounds=rounds)
    named = f"tick, {parts:,} parts aged"
    yield Line(f"{named}: p and q of the next {MISSION:g} h", times[0], times[1], f"{PEER}, live call", goal=goal)
    yield Line(f"{named}: p, q, f now, hazard rate", times[2], times[3], f"{PEER}, importances and hf", goal=goal)
    yield Line(f"{named}: p, q, f since new", times[4], times[5], f"{PEER}, p alone")


@benchmark
def tick_100() -> Iterator[Line]:
    yield from tick(100, 15, 1 / 200)


@benchmark
def tick_10000() -> Iterator[Line]:
    yield from tick(10_000, 3, 1 / 2000)


@benchmark
def curve_after_a_tick() -> Iterator[Line]:
    """Sixty-four points of the reliability to come, each of 10,000 parts of an age of its own."""
    twin = twins(10_000)
    plant, diagram = Plant(twin.robot), twin.robot.diagram
    age, hours = ages(10_000, 5), np.linspace(1.0, 640.0, 64)
    now = twin.state(age)

    def ours() -> np.ndarray:
        return nominal_outlook(plant, age).curve(diagram)(hours)[1]

    def theirs() -> np.ndarray:
        return np.asarray(twin.rbd.sf_given_state(hours, now))

    agree("64 points", ours(), theirs(), 1e-9)
    yield Line(
        "curve of 64 points, 10,000 parts aged", *race(ours, theirs, rounds=3), f"{PEER}, live call", goal=1 / 50
    )


def thousand_times(types: int | None, goal: float) -> Iterator[Line]:
    twin, hours = twins(10_000, types, ageing=True), np.linspace(1.0, 2000.0, 1000)
    plant, diagram = Plant(twin.robot), twin.robot.diagram
    outlook, units = as_designed(plant), len(plant.system(diagram).structure.names)

    def ours() -> np.ndarray:
        return outlook.reliability_curve(diagram, hours)[0]

    def theirs() -> np.ndarray:
        return np.asarray(twin.rbd.sf(hours))

    x, power = np.random.default_rng(1).uniform(0.0, 1.0, (10_000, 10)), np.linspace(1.0, 4.0, 10_000)[:, None]
    out = np.empty_like(x)

    def bare() -> None:
        """The powers of all parts, exp and expm1 of what is left of them in series; ten times, which stay in cache."""
        np.power(x, power, out=out)
        np.exp(x[:units], out=out[:units])
        np.expm1(x[:units], out=out[:units])

    agree("R(t)", ours(), theirs(), 1e-9)
    mine, peer, arithmetic = race(ours, theirs, bare, rounds=5)
    work = f"R(t) at 1,000 times, 10,000 Weibull parts{f' of {types} types' if types else ''}"
    yield Line(work, mine, peer, PEER, goal=goal)
    if not types:
        yield Line(work, mine, arithmetic * 100, "power, exp and expm1 alone", goal=1.4)


@benchmark
def a_thousand_times() -> Iterator[Line]:
    """Since new, of parts that are all different, beside the bare arithmetic of it."""
    yield from thousand_times(None, 1 / 2)


@benchmark
def a_thousand_times_of_few_types() -> Iterator[Line]:
    yield from thousand_times(50, 1 / 50)


@benchmark
def fleet() -> Iterator[Line]:
    """Ten thousand robots of a hundred parts, all of different ages: the next ten hours of each."""
    twin, robots = twins(100), 10_000
    plant, diagram = Plant(twin.robot), twin.robot.diagram
    age = np.random.default_rng(11).uniform(100.0, 3000.0, (100, robots))

    def ours() -> np.ndarray:
        return Fleet.designed(plant, age).ahead(diagram, MISSION)[1]

    def one_by_one() -> list[float]:
        """Twenty of them."""
        return [float(twin.rbd.sf_given_state(MISSION, twin.state(age[:, robot]))) for robot in range(20)]

    def side_by_side() -> np.ndarray:
        """By the peer's path for arrays: what its lives give for all robots, then the system once."""
        lives = ((twin.models[name], one) for name, one in zip(twin.names, age, strict=True))
        return twin.system([life.sf(one + MISSION) / life.sf(one) for life, one in lives])

    found = ours()
    agree("twenty robots", found[:20], one_by_one(), 1e-9)
    agree("all robots", found, side_by_side(), 1e-9)
    mine, twenty, arrays = race(ours, one_by_one, side_by_side, rounds=5)
    work = f"{robots:,} robots of 100 parts: the next {MISSION:g} h"
    yield Line(work, mine, twenty * robots / 20, f"{PEER}, robot by robot (20 timed)", goal=1 / 5000)
    yield Line(work, mine, arrays, f"{PEER}, arrays", goal=1 / 2)


@benchmark
def mean_life() -> Iterator[Line]:
    twin = twins(100)
    plant, diagram = Plant(twin.robot), twin.robot.diagram
    age = ages(100, 7)
    now = twin.state(age)

    def ours() -> float:
        return nominal_outlook(plant, age).mean_remaining_life(diagram)

    def theirs() -> float:
        return float(twin.rbd.mean_residual_life(now))

    agree("mean remaining life", ours(), theirs(), 1e-9)
    yield Line("mean remaining life, 100 parts aged", *race(ours, theirs, rounds=5), PEER, goal=1 / 200)
    new = nominal_outlook(plant, np.zeros(100))

    def ours_new() -> float:
        return new.mean_remaining_life(diagram)

    agree("mean life", ours_new(), twin.rbd.mean(), 1e-9)
    yield Line("mean life, 100 parts", *race(ours_new, twin.rbd.mean, rounds=5), PEER, goal=1 / 200)
