"""A live tick and remaining life, against RePyability's calls that take the age of every part."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks import Line, agree, benchmark, race
from benchmarks.designs import MISSION, Twins, ages, twins
from robophm.health.prognosis import Figures, Plant, nominal_outlook

PEER = "RePyability"


def of_peer(twin: Twins, age: np.ndarray) -> tuple[float, float, float]:
    """Survival since new, hazard rate now [1/h] and completion of the mission, by public calls of the peer."""
    state = dict(zip(twin.names, age.tolist(), strict=True))
    new = [twin.models[name].sf(state[name]) for name in twin.names]
    weight = twin.rbd.importances_given_state(0.0, state)["birnbaum"]
    hazard = sum(weight[name] * float(np.squeeze(twin.models[name].hf(state[name]))) for name in twin.names)
    return float(twin.system(new)[0]), hazard, float(twin.rbd.sf_given_state(MISSION, state))


def tick(parts: int) -> Iterator[Line]:
    twin = twins(parts)
    plant, diagram, task = Plant(twin.robot), twin.robot.diagram, twin.robot.task
    assert task is not None

    def ours(age: np.ndarray) -> Figures:
        return nominal_outlook(plant, age).figures(diagram, task, remaining_life=False)

    def completion(age: np.ndarray) -> float:
        return nominal_outlook(plant, age).completion(diagram, task).probability

    def given_state(age: np.ndarray) -> float:
        return float(twin.rbd.sf_given_state(MISSION, dict(zip(twin.names, age.tolist(), strict=True))))

    for moment in range(5):
        age = ages(parts, moment)
        figures = ours(age)
        assert figures.completion is not None
        found = figures.reliability, figures.hazard_rate, figures.completion.probability
        agree(f"tick of {parts} parts", found, of_peer(twin, age), 1e-9)
        agree(f"completion by {parts} parts", completion(age), given_state(age), 1e-9)
    age = ages(parts, 99)
    all_ours, one_ours, all_theirs, one_theirs = race(
        lambda: ours(age), lambda: completion(age), lambda: of_peer(twin, age), lambda: given_state(age)
    )
    yield Line(f"live tick, {parts:,} parts: R, h and completion", all_ours, all_theirs, PEER)
    yield Line(f"live tick, {parts:,} parts: completion alone", one_ours, one_theirs, PEER)


@benchmark
def tick_100() -> Iterator[Line]:
    yield from tick(100)


@benchmark
def tick_1000() -> Iterator[Line]:
    yield from tick(1000)


@benchmark
def remaining_life() -> Iterator[Line]:
    twin = twins(100)
    plant, age = Plant(twin.robot), ages(100, 7)
    state = dict(zip(twin.names, age.tolist(), strict=True))

    def ours() -> list[float]:
        life = nominal_outlook(plant, age).remaining_life(twin.robot.diagram)
        return [life.early, life.median, life.late, life.mean]

    def theirs() -> list[float]:
        return [*twin.rbd.remaining_life([0.95, 0.5, 0.05], state), twin.rbd.mean_residual_life(state)]

    agree("remaining life", ours(), theirs(), 1e-8)
    yield Line("remaining life, 100 parts: 5, 50, 95 % and mean", *race(ours, theirs, rounds=5), PEER)
