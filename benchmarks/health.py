"""A live tick and remaining life, against RePyability's calls that take the age of every part."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from pathlib import Path

import numpy as np

from benchmarks import Line, agree, benchmark, race
from benchmarks.designs import FUNCTIONS, MISSION, Twins, ages, function, twins, uncertain
from robophm.core.waiting_time import time_at
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Leg, Task
from robophm.health.drawn_rates import draw_rates
from robophm.health.mission import completion as of_task
from robophm.health.outlooks import nominal_outlook
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.subject import Figures, figures
from robophm.health.uncertainty import life_uncertainty, predictive_life

PEER = "RePyability"

DRAWS = 10_000


def of_peer(twin: Twins, age: np.ndarray) -> tuple[float, float, float]:
    """Survival since new, hazard rate now [1/h] and completion of the mission, by public calls of the peer."""
    state = twin.state(age)
    new = [twin.models[name].sf(state[name]) for name in twin.names]
    weight = twin.rbd.importances_given_state(0.0, state)["birnbaum"]
    hazard = sum(weight[name] * float(np.squeeze(twin.models[name].hf(state[name]))) for name in twin.names)
    return float(twin.system(new)[0]), hazard, float(twin.rbd.sf_given_state(MISSION, state))


def tick(parts: int) -> Iterator[Line]:
    twin = twins(parts)
    plant, diagram, task = Plant(twin.robot), twin.robot.diagram, twin.robot.task
    assert task is not None

    def ours(age: np.ndarray) -> Figures:
        return figures(nominal_outlook(plant, age), diagram, task, remaining_life=False)

    def completion(age: np.ndarray) -> float:
        return of_task(nominal_outlook(plant, age), task).probability

    def given_state(age: np.ndarray) -> float:
        return float(twin.rbd.sf_given_state(MISSION, twin.state(age)))

    for moment in range(5):
        age = ages(parts, moment)
        health = ours(age)
        assert health.completion is not None
        found = health.reliability, health.hazard_rate, health.completion.probability
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
def phased_mission() -> Iterator[Line]:
    """A task as it arrives: its legs have never been seen before, its functions have."""
    from repyability import PhasedMission

    twin = twins(100)
    plant = Plant(twin.robot)
    functions = {name: function(name) for name in FUNCTIONS}
    order = [list(FUNCTIONS)[i] for i in np.random.default_rng(3).integers(0, 3, 20)]
    new = np.zeros(len(twin.names))
    tasks = count()

    def legs(task: int) -> list[tuple[str, float]]:
        hours = np.random.default_rng(task).uniform(0.1, 5.0, len(order))
        return list(zip(order, hours.tolist(), strict=True))

    def ours(task: int) -> float:
        asked = Task(tuple(Leg(hours, functions=(name,)) for name, hours in legs(task)))
        return of_task(nominal_outlook(plant, new), asked).probability

    def theirs(task: int) -> float:
        phases = [(i, hours, functions[name]) for i, (name, hours) in enumerate(legs(task))]
        return float(PhasedMission(phases).reliability())

    for task in range(5):
        agree("phased mission", ours(task), theirs(task), 1e-9)
    yield Line(
        "task of 20 legs and 3 functions, 100 parts", *race(lambda: ours(next(tasks)), lambda: theirs(next(tasks))),
        PEER, goal=1 / 20,
    )  # fmt: skip


@benchmark
def remaining_life() -> Iterator[Line]:
    twin = twins(100)
    plant, age = Plant(twin.robot), ages(100, 7)
    state = twin.state(age)

    def quantiles() -> list[float]:
        """Nothing but the three, as the peer's call gives them one by one."""
        survives = np.array([0.95, 0.5, 0.05])
        curve = nominal_outlook(plant, age).curve(twin.robot.diagram)
        return [float(time) for time in time_at(curve, 1 - survives, survives)]

    def of_theirs() -> list[float]:
        return [float(twin.rbd.remaining_life(level, state)) for level in (0.95, 0.5, 0.05)]

    agree("remaining life, quantiles", quantiles(), of_theirs(), 1e-8)
    yield Line("remaining life, 100 parts: 5, 50, 95 %", *race(quantiles, of_theirs, rounds=5), PEER, goal=1 / 300)

    def ours() -> list[float]:
        life = nominal_outlook(plant, age).remaining_life(twin.robot.diagram)
        return [life.early, life.median, life.late, life.mean]

    def theirs() -> list[float]:
        return [*twin.rbd.remaining_life([0.95, 0.5, 0.05], state), twin.rbd.mean_residual_life(state)]

    agree("remaining life", ours(), theirs(), 1e-8)
    yield Line("remaining life, 100 parts: 5, 50, 95 % and mean", *race(ours, theirs, rounds=5), PEER)


@benchmark
def uncertain_life() -> Iterator[Line]:
    """Rates drawn 10,000 times: the predictive 5, 50 and 95 %, against closed forms before it is timed."""
    rate, failures = 1e-3, 2.0
    alone = parse(f"schema_version: 1\nname: one\ncomponents: {{a: {{rate: {rate} /h, uncertainty: {{failures: 2}}}}}}")
    one = nominal_outlook(Plant(alone), np.zeros(1))
    found = life_uncertainty(one, alone.diagram, draws=DRAWS).all_sources
    agree("gamma rates", found, [failures / rate * (p ** (-1 / failures) - 1) for p in (0.95, 0.5, 0.05)], 1e-3)
    text = (Path(__file__).parents[1] / "examples" / "ota" / "robot.yaml").read_text(
        encoding="utf-8"
    ) + "\nuncertainty: {error_factor: 3}\n"
    for name, robot in (("the OTA robot", parse(text)), ("100 parts", uncertain(100))):
        plant = Plant(robot)
        outlook = nominal_outlook(plant, np.full(len(robot.modes), 500.0))

        def ours(outlook: Outlook = outlook, robot: Robot = robot) -> None:
            ratios = draw_rates(outlook.plant, DRAWS, seed=0)
            predictive_life(outlook, robot.diagram, ratios, [outlook.future])

        (seconds,) = race(ours, rounds=5)
        yield Line(f"remaining life, {name}, {DRAWS:,} draws of all rates (goal 0.25 s)", seconds)
