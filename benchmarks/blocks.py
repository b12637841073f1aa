"""The diagram alone, the states of its units given, against RePyability's exact evaluation and its importances."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count

import numpy as np

from benchmarks import Line, agree, benchmark, race
from benchmarks.designs import MISSION, ages, twins
from robophm.blocks.diagram import KOutOfN, Unit
from robophm.blocks.reliability import State, Structure


def evaluate(parts: int, columns: int) -> Line:
    twin = twins(parts)
    structure = Structure(twin.robot.diagram)
    rng = np.random.default_rng(columns)
    failed = 10 ** rng.uniform(-6, -1, (parts, columns))
    density = failed * rng.uniform(0.5, 1.5, failed.shape)
    works = 1 - failed
    row = [twin.names.index(name) for name in structure.names]
    given = failed[row], density[row], works[row]

    def ours() -> State:
        b, c, s = given
        return structure.state(s, b, c)

    def theirs() -> np.ndarray:
        return twin.system(works)

    state = ours()
    agree(f"reliability of {parts} units", state.works, theirs(), 1e-9)
    # the peer's derivative by each unit, all of them as columns of one evaluation of the first state
    up, down = (np.where(np.eye(parts) == 1, held, works[:, :1]) for held in (1.0, 0.0))
    weight = twin.system(up) - twin.system(down)
    agree(f"density of {parts} units", state.density[0], weight @ density[:, 0], 1e-9)
    noun = "state" if columns == 1 else "states"
    return Line(f"diagram of {parts} units, {columns:,} {noun}: R, F, f", *race(ours, theirs), "RePyability, R alone")


@benchmark
def diagram() -> Iterator[Line]:
    yield evaluate(100, 1)
    yield evaluate(100, 10_000)


def what_if(parts: int, rounds: int, goal: float) -> Iterator[Line]:
    """One unit is something else: ours refolds its path; the peer evaluates all, or is asked as for any live state."""
    twin = twins(parts)
    structure = Structure(twin.robot.diagram)
    moment, row = structure.moment(), [twin.names.index(name) for name in structure.names]
    age = ages(parts, 1)
    state = twin.state(age)
    works = np.array([float(twin.models[name].sf(MISSION + state[name])) for name in twin.names])
    works /= np.array([float(twin.models[name].sf(state[name])) for name in twin.names])
    moment.set(works[row], 1 - works[row], 1 - works[row])
    asked = count()

    def ours(i: int) -> float:
        return float(moment.what_if(twin.names[i * 7 % parts], 0.9, 0.1, 1e-3).works)

    def probability(i: int) -> float:
        changed = works.copy()
        changed[i * 7 % parts] = 0.9
        return float(np.squeeze(twin.system(changed)))

    def live(i: int) -> float:
        name = twin.names[i * 7 % parts]
        return float(twin.rbd.sf_given_state(MISSION, state | {name: state[name] / 2}))

    agree(f"what-if of {parts} units", [ours(i) for i in range(5)], [probability(i) for i in range(5)], 1e-9)
    for i in range(parts):  # every path once
        ours(i)
    times = race(*(lambda one=one: one(next(asked)) for one in (ours, probability, live)), rounds=rounds)
    work = f"what-if, one of {parts:,} units: p, q, f"
    yield Line(work, times[0], times[1], "RePyability, p alone, units given")
    yield Line(work, times[0], times[2], "RePyability, live call", goal=goal)


@benchmark
def what_if_100() -> Iterator[Line]:
    yield from what_if(100, 15, 1 / 500)


@benchmark
def what_if_10000() -> Iterator[Line]:
    yield from what_if(10_000, 3, 1 / 10_000)


@benchmark
def birnbaum() -> Iterator[Line]:
    """Every unit's importance at one age, the probabilities of the units included on the peer's side only."""
    twin = twins(10_000)
    structure, hours = Structure(twin.robot.diagram), 100.0
    failed = np.array([float(np.squeeze(-np.expm1(-twin.models[name].Hf(hours)))) for name in structure.names])

    def ours() -> np.ndarray:
        return structure.birnbaum(1 - failed, failed)

    def theirs() -> dict[str, float]:
        found: dict[str, float] = twin.rbd.birnbaum_importance(hours)
        return found

    peer = theirs()
    agree("Birnbaum importances", ours(), [float(np.squeeze(peer[name])) for name in structure.names], 1e-9)
    times = race(ours, theirs, rounds=5)
    yield Line("Birnbaum importance of all 10,000 units", *times, "RePyability", goal=1 / 1000)


@benchmark
def five_hundred_of_a_thousand() -> Iterator[Line]:
    import surpyval
    from repyability import NonRepairableRBD, PerfectReliability

    units = [Unit(f"u{i}") for i in range(1000)]
    structure = Structure(KOutOfN(500, *units))
    failed = np.random.default_rng(5).uniform(0.3, 0.7, 1000)
    edges = [("in", unit.name) for unit in units] + [(unit.name, "vote") for unit in units] + [("vote", "out")]
    lives = {
        unit.name: surpyval.Exponential.from_params([-float(np.log1p(-q))])
        for unit, q in zip(units, failed, strict=True)
    }
    peer = NonRepairableRBD(edges, lives | {"vote": PerfectReliability}, {"vote": 500})

    def ours() -> float:
        return float(structure.probability(1 - failed, failed)[0])

    def theirs() -> float:
        return float(np.squeeze(peer.sf(1.0)))

    agree("500 of 1000", ours(), theirs(), 1e-9)
    yield Line("500 of 1,000 different units", *race(ours, theirs, rounds=5), "RePyability", goal=1 / 200)


@benchmark
def ninety_nine_thousand_of_a_hundred_thousand() -> Iterator[Line]:
    from scipy.stats import binom

    n, k, p = 100_000, 99_000, 0.9905
    structure = Structure(KOutOfN(k, *(Unit(f"u{i}") for i in range(n))))
    works, failed = np.full(n, p), np.full(n, 1 - p)
    found = structure.probability(works, failed)
    agree("99,000 of 100,000", np.array(found), np.array([binom.sf(k - 1, n, p), binom.cdf(k - 1, n, p)]), 1e-9)
    yield Line("99,000 of 100,000 units", *race(lambda: structure.probability(works, failed), rounds=3))
