"""Tasks by random nested designs: modules in modules, equal parts, functions that share them, against brute force."""

from __future__ import annotations

import json
import random
from itertools import product
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Leg, Task
from robophm.health.importance import Drawn, importances
from robophm.health.mission import completion, deciding_components
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

from ..structures import works

RATE, AGE = 0.01, 40.0
MOST = 7  # units, each of which fails in one of at most five stretches


def design(rng: random.Random) -> dict[str, Any]:
    """A robot of nested modules; its functions need a module by itself, and have it in a parallel or a k-of-n."""
    count = 0

    def part() -> dict[str, Any]:
        nonlocal count
        count += 1
        return {"rate": f"{RATE * (1 + count)!r} /h", "initial_exposure": f"{AGE if rng.random() < 0.7 else 0.0!r} h",
                "monitored": rng.random() < 0.15}  # fmt: skip

    def redundant(names: list[str]) -> Any:
        kind = rng.choice(["parallel", "parallel", "k_of_n"])
        return {kind: {"k": rng.randint(1, len(names)), "of": names}} if kind == "k_of_n" else {kind: names}

    inner = {"components": {name: part() for name in "ab"}, "diagram": redundant(["a", "b"])}
    own: dict[str, Any] = {"c": part()}
    if rng.random() < 0.4:
        own["c"] |= {"quantity": 2, "required": rng.choice([1, 1, 2])}
    drawn: list[Any] = ["c", "In"] if rng.random() < 0.8 else [redundant(["c", "In"]), "c"]
    outer = {"components": own, "modules": {"In": inner}, "diagram": {"series": drawn}}
    components = {"d": part()} | ({"e": part()} if rng.random() < 0.5 else {})
    others = [*components, *(["Out/In", "Out/c"] if rng.random() < 0.25 else [])]  # or nobody else draws what is in it

    def block() -> Any:
        kind = rng.choice(["parallel", "k_of_n", "series"])
        more = rng.sample(others, rng.randint(1, min(2, len(others))))
        if kind == "series":
            return {"series": [redundant(["Out", rng.choice([*components])]), more[0]]}
        return redundant(["Out", *more])

    functions = {"drive": rng.choice(["Out", "Out", {"series": ["Out", "d"]}]),
                 "carry": block(), "look": block()}  # fmt: skip
    return {"schema_version": 1, "name": "R", "modules": {"Out": outer}, "components": components,
            "functions": functions, "diagram": redundant(["Out", "d"])}  # fmt: skip


def legs(rng: random.Random) -> list[Leg]:
    needs = [("drive", "carry"), ("carry",), ("drive",), ("look", "drive"), (), ("drive", "look", "carry")]
    return [Leg(rng.choice([0.5, 3.0, 20.0]), functions=rng.choice(needs)) for _ in range(rng.randint(1, 3))]


def expected(robot: Robot, task: list[Leg]) -> tuple[mpf, mpf]:
    """P(fails), P(is completed), by the sum over all stretches in which each unit may fail."""
    weight, names = np.array([mpf(1)], dtype=object), []
    for part in robot.all_components():
        rate = mpf(part.modes[0].rate)
        for unit in part.units:
            equal = part.quantity if len(part.units) == 1 else 1
            hours = [0.0 if part.monitored else part.modes[0].initial_exposure, *(leg.duration for leg in task)]
            ends = np.cumsum(np.array([mpf(one) for one in hours], dtype=object))
            left = [mpf(1), *(mp.exp(-rate * equal * end) for end in ends)]
            one = np.array([*(left[i] - left[i + 1] for i in range(len(ends))), left[-1]], dtype=object)
            weight = np.multiply.outer(weight, one).ravel()
            names.append(unit)
    fails_in = np.array(list(product(range(len(task) + 2), repeat=len(names)))).T

    def hold(phase: int, functions: tuple[str, ...]) -> np.ndarray:
        state = {name: when > phase for name, when in zip(names, fails_in, strict=True)}
        return np.all([works(robot.functions[f] if f else robot.diagram, state) for f in functions or ("",)], axis=0)

    before = np.all([hold(0, leg.functions) for leg in task], axis=0)
    after = np.all([hold(k, leg.functions) for k, leg in enumerate(task, 1)], axis=0)
    c, s = mp.fsum(weight[before & ~after]), mp.fsum(weight[before & after])
    return c / (c + s), s / (c + s)


@pytest.mark.parametrize("seed", range(60))
def test_tasks_of_nested_designs(seed: int) -> None:
    rng = random.Random(seed)
    robot = parse(json.dumps(design(rng)))
    task = legs(rng)
    if sum(len(part.units) for part in robot.all_components()) > MOST - len(task) // 3:
        task = task[:1]
    outlook = as_designed(Plant(robot))
    found = completion(outlook, Task(tuple(task)))
    with mp.workdps(30):
        failure, probability = expected(robot, task)
    assert found.failure == pytest.approx(float(failure), rel=1e-12, abs=0)
    assert found.probability == pytest.approx(float(probability), rel=1e-12, abs=0)
    for one in deciding_components(outlook, Task(tuple(task))):
        assert 0 <= one.failure_without <= found.failure * (1 + 1e-12)
    if seed % 6 == 0:
        for diagram in (robot.diagram, *robot.functions.values()):
            assert importances(outlook, Drawn(outlook.plant, diagram), 10.0, lifelong=False).failure > 0
