"""Tasks of legs by real designs: against the sum over all orders of failure, the laws, and worked figures."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any, ClassVar

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mpmath import mp, mpf

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Unit
from robophm.core.errors import DesignError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.design.task_file import parse_plan
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, completion, deciding, following, repetitions
from robophm.health.outlooks import as_designed, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def exact(value: Any, rel: float = 1e-12) -> Any:
    return pytest.approx(float(value), rel=rel, abs=0)


def lived(design: Robot, knowledge: Knowledge | None = None) -> Outlook:
    """The sensor-based view, which takes the stresses that a task states."""
    return outlooks(Plant(design), ExposureIntegrator(design), Ledger.new(design), knowledge=knowledge)["sensor_based"]


def same(found: Completion, probability: Any, failure: Any, rel: float = 1e-12) -> None:
    assert found.probability == exact(probability, rel)
    assert found.failure == exact(failure, rel)


def hour(*functions: str, hours: float = 1.0, **more: Any) -> Leg:
    return Leg(hours, functions=functions, **more)


# Against the sum over all orders of failure.


@dataclass
class Part:
    """A part as the design says it and, beside that, its cumulative hazard as a textbook does."""

    name: str
    life: str
    scaling: str
    clock: str
    stress: str
    initial: float
    monitored: bool
    duty: float
    quantity: int
    required: int

    SCALES: ClassVar = {"operating": 100.0, "calendar": 150.0, "kilometres": 30.0, "cycles": 4000.0, "starts": 50.0}
    UNITS: ClassVar = {"operating": "h", "calendar": "h", "kilometres": "km", "cycles": "cycle", "starts": "start"}

    @staticmethod
    def draw(rng: random.Random, name: str, quantity: int) -> Part:
        clock = rng.choice(list(Part.SCALES))
        return Part(
            name,
            rng.choice(["exponential", "weibull", "infant", "lognormal"]),
            rng.choice(["age", "hazard"]),
            clock,
            rng.choice(["", "temperature", "load"]),
            rng.choice([0.0, 0.3, 0.9]) * Part.SCALES[clock],
            rng.random() < 0.3,
            rng.choice([1.0, 0.2, 0.0]),
            quantity,
            rng.randint(1, quantity),
        )

    def written(self) -> dict[str, Any]:
        unit, scale = self.UNITS[self.clock], self.SCALES[self.clock]
        life: dict[str, Any] = {
            "exponential": {"distribution": "exponential"},
            "weibull": {"distribution": "weibull", "shape": 2.5, "scale": f"{scale} {unit}"},
            "infant": {"distribution": "weibull", "shape": 0.5, "scale": f"{scale} {unit}"},
            "lognormal": {"distribution": "lognormal", "log_deviation": 0.75},
        }[self.life]
        return {
            "life": life,
            **({} if "scale" in life else {"rate": f"{1 / scale!r} /{unit}"}),
            "scaling": self.scaling,
            "clock": self.clock,
            "acceleration": {
                "": "none",
                "temperature": {"model": "q10", "reference_temperature": "25 degC"},
                "load": {"model": "cubic_load"},
            }[self.stress],
            "initial_exposure": f"{self.initial!r} {unit}",
            "monitored": self.monitored,
            "duty": self.duty,
            "quantity": self.quantity,
            "required": self.required,
        }

    @property
    def units(self) -> list[str]:
        told_apart = self.quantity > self.required
        return [f"{self.name}[{i + 1}]" for i in range(self.quantity)] if told_apart else [self.name]

    def hazard(self, age: mpf) -> mpf:
        """H₀ of one unit."""
        scale = mpf(self.SCALES[self.clock])
        if age == 0:
            return mpf(0)
        match self.life:
            case "exponential":
                one = age * mpf(1 / self.SCALES[self.clock])
            case "weibull":
                one = (age / scale) ** mpf(2.5)
            case "infant":
                one = mp.sqrt(age / scale)
            case _:
                z = (mp.log(age / scale) + mpf(0.75) ** 2 / 2) / mpf(0.75)
                one = -mp.log(mp.erfc(z / mp.sqrt(2)) / 2)
        return one * (self.quantity if len(self.units) == 1 else 1)

    def factor(self, leg: Leg) -> mpf:
        for key in (f"{self.name}/{self.stress}", self.stress):
            if self.stress and key in leg.stresses:
                stated = mpf(leg.stresses[key])
                return mpf(2) ** ((stated - 25) / 10) if self.stress == "temperature" else abs(stated) ** 3
        return mpf(1)

    def hazards(self, legs: Sequence[Leg], needed: Sequence[bool], works: bool, *, nominal: bool) -> list[mpf]:
        """What the past and each leg add to the cumulative hazard of one unit."""
        gone = aged = mpf(self.initial)
        found = [mpf(0) if works else self.hazard(gone)]
        for leg, need in zip(legs, needed, strict=True):
            hours = mpf(leg.duration)
            advance = {
                "operating": hours,
                "calendar": hours,
                "kilometres": mpf(leg.distance) / 1000,
                "cycles": 40 * hours if leg.cycles is None else mpf(leg.cycles),
                "starts": hours / 2 if leg.starts is None else mpf(leg.starts),
            }[self.clock]
            if not need and self.clock != "calendar":
                advance *= mpf(self.duty)
            factor = mpf(1) if nominal else self.factor(leg)
            if self.scaling == "age":
                found.append(self.hazard(aged + factor * advance) - self.hazard(aged))
            else:
                found.append(factor * (self.hazard(gone + advance) - self.hazard(gone)))
            gone, aged = gone + advance, aged + factor * advance
        return found


@dataclass
class Case:
    """A random robot with a task and what is known."""

    parts: list[Part]
    functions: dict[str, Any]
    legs: list[Leg]
    knowledge: Knowledge = field(default_factory=Knowledge)

    @staticmethod
    def draw(seed: int) -> Case:
        rng = random.Random(seed)
        quantities = rng.choice([[1, 1, 1, 1], [1, 1, 2], [2, 2, 1], [3, 1], [1, 1, 1]])
        parts = [Part.draw(rng, f"p{i}", n) for i, n in enumerate(quantities)]
        names = [part.name for part in parts]

        def block(size: int) -> Any:
            if size == 1:
                return rng.choice(names)
            cut = rng.randint(1, size - 1)
            inner = [block(cut), block(size - cut)]
            kind = rng.choice(["series", "parallel", "k_of_n"])
            return {kind: {"k": 2, "of": [*inner, block(1)]} if kind == "k_of_n" else inner}

        functions = {name: block(rng.randint(1, 5)) for name in ("f", "g")}
        legs = []
        for _ in range(rng.randint(1, 3)):
            stresses = {}
            if rng.random() < 0.6:
                stresses["temperature"] = rng.choice([5.0, 40.0, 60.0])
            if rng.random() < 0.6:
                stresses["load"] = rng.choice([0.0, 0.5, 1.3])
            for part in parts:
                if part.stress and rng.random() < 0.3:
                    stresses[f"{part.name}/{part.stress}"] = rng.choice([0.7, 1.9])
            legs.append(
                Leg(
                    rng.choice([1e-9, 0.01, 5.0, 60.0]),
                    rng.choice([0.0, 20.0, 5000.0]),
                    rng.choice([None, 0.0, 300.0]),
                    rng.choice([None, 2.0]),
                    rng.choice([(), ("f",), ("g",), ("f", "g")]),
                    stresses,
                )
            )
        units = [unit for part in parts for unit in part.units]
        known = rng.choice([[], [], units[:1], units])
        failed = frozenset(unit for unit in known if rng.random() < 0.25)
        working = frozenset(unit for unit in known if unit not in failed and rng.random() < 0.6)
        return Case(parts, functions, legs, Knowledge(failed, working))

    def design(self) -> Robot:
        usage = {"kilometres": "1 km/h", "cycles": "40 cycle/h", "starts": "0.5 start/h"}
        parts = {part.name: part.written() for part in self.parts}
        return robot(parts, functions=self.functions, usage=usage, diagram={"parallel": ["p0", "p1"]})

    def expected(self, design: Robot, *, nominal: bool) -> tuple[mpf, mpf]:
        """P(the task fails), P(it is completed): the functions of each leg at its end, given all of them now."""
        diagrams = {"": design.diagram, **design.functions}
        drawn = {name: _drawn(diagram) for name, diagram in diagrams.items()}
        needs = [leg.functions or ("",) for leg in self.legs]
        units, weights = [], []
        for part in self.parts:
            needed = [any(set(part.units) & drawn[function] for function in need) for need in needs]
            for unit in part.units:
                works = part.monitored or unit in self.knowledge.working
                hazards = part.hazards(self.legs, needed, works, nominal=nominal)
                survived = mpf(1)
                stretch = []
                for hazard in hazards:
                    stretch.append(survived * -mp.expm1(-hazard))
                    survived *= mp.exp(-hazard)
                if unit in self.knowledge.failed:
                    stretch, survived = [mpf(1), *[mpf(0)] * len(self.legs)], mpf(0)
                units.append(unit)
                weights.append([*stretch, survived])
        weight = np.array([mpf(1)], dtype=object)
        for one in weights:
            weight = np.multiply.outer(weight, np.array(one, dtype=object)).ravel()
        fails_in = np.array(list(product(range(len(self.legs) + 2), repeat=len(units)))).T

        def hold(phase: int, function: str) -> np.ndarray:
            state = {unit: when > phase for unit, when in zip(units, fails_in, strict=True)}
            return _works(diagrams[function], state)

        before = np.all([hold(0, function) for need in needs for function in need], axis=0)
        after = np.all([hold(k + 1, function) for k, need in enumerate(needs) for function in need], axis=0)
        c, s = mp.fsum(weight[before & ~after]), mp.fsum(weight[before & after])
        return (c / (c + s), s / (c + s)) if c + s > 0 else (mpf(1), mpf(0))


def _drawn(block: Block) -> set[str]:
    return {block.name} if isinstance(block, Unit) else set().union(*map(_drawn, block.blocks))


def _works(block: Block, state: dict[str, np.ndarray]) -> np.ndarray:
    if isinstance(block, Unit):
        return state[block.name]
    inner = np.array([_works(each, state) for each in block.blocks])
    k = block.k if isinstance(block, KOutOfN) else 1 if isinstance(block, Parallel) else len(inner)
    return inner.sum(axis=0) >= k


@pytest.mark.parametrize("seed", range(120))
def test_random_robots_and_tasks(seed: int) -> None:
    case = Case.draw(seed)
    design = case.design()
    views = outlooks(Plant(design), ExposureIntegrator(design), Ledger.new(design), knowledge=case.knowledge)
    for view, outlook in views.items():
        failure, probability = case.expected(design, nominal=view == "nominal")
        same(completion(outlook, Task(tuple(case.legs))), probability, failure)


# The worked figures of the theory.


def a_or_b(rate: float, age: float = 0.0, **more: Any) -> Robot:
    part = {"rate": f"{rate!r} /h", "initial_exposure": f"{age!r} h", **more}
    return robot({"a": part, "b": part}, functions={"a": "a", "either": {"parallel": ["a", "b"]}})


THEN_EITHER = Task((hour("a"), hour("either")))


def test_a_then_a_or_b_is_neither_the_product_nor_the_end_state() -> None:
    """One hour that needs a, one that needs a or b, rate 0.1: 0.889; product of legs 0.897, end state 0.967."""
    outlook = as_designed(Plant(a_or_b(0.1)))
    p = mp.exp(-mpf(0.1))
    same(completion(outlook, THEN_EITHER), p**2 + (p - p**2) * p**2, 1 - p**2 - (p - p**2) * p**2)
    assert round(completion(outlook, THEN_EITHER).probability, 3) == 0.889
    alone = [completion(outlook, Task((leg,))).probability for leg in THEN_EITHER.legs]
    assert alone == [exact(p), exact(1 - (1 - p) ** 2)]
    assert round(math.prod(alone), 3) == 0.897
    end = completion(outlook, Task((hour("either", hours=2.0),)))
    same(end, 1 - (1 - p**2) ** 2, (1 - p**2) ** 2)
    assert round(end.probability, 3) == 0.967


def test_after_a_success_is_not_after_works_now() -> None:
    """Rate 0.3: 0.883 given that a has worked for an hour, 0.854 given only that one of the two has."""
    p = mp.exp(-mpf(0.3))
    new, old = (Plant(a_or_b(0.3, age)) for age in (0.0, 1.0))
    after = 1 - (1 - p) * (1 - p**2)  # a is as new, b has lived for two hours
    both = completion(as_designed(new), THEN_EITHER).probability
    first = completion(as_designed(new), Task((hour("a"),))).probability
    assert both / first == exact(after)
    assert round(both / first, 3) == 0.883
    either = Task((hour("either"),))
    same(completion(as_designed(old, Knowledge(working=frozenset("a"))), either), after, 1 - after)
    works_now = completion(as_designed(old), either)
    same(works_now, (1 - (1 - p**2) ** 2) / (1 - (1 - p) ** 2), 1 - (1 - (1 - p**2) ** 2) / (1 - (1 - p) ** 2))
    assert round(works_now.probability, 3) == 0.854


def test_a_pair_loses_no_digits() -> None:
    """For a parallel pair 1 − R(t + m)/R(t) has lost half of its digits; the completion has all."""
    rate, age, ahead = 1e-4, 1.0, 0.05
    design = robot(
        {name: {"rate": f"{rate!r} /h", "initial_exposure": f"{age!r} h"} for name in "ab"},
        diagram={"parallel": ["a", "b"]},
    )
    found = completion(as_designed(Plant(design)), hour_task(ahead))
    now, end = (-mp.expm1(-mpf(rate) * t) for t in (mpf(age), mpf(age) + mpf(ahead)))
    fails = (end**2 - now**2) / (1 - now**2)
    same(found, 1 - fails, fails, 2e-16)

    def survival(t: float) -> float:
        return 1 - (1 - math.exp(-rate * t)) ** 2

    naive = 1 - survival(age + ahead) / survival(age)
    assert 1e-9 < abs(naive / float(fails) - 1) < 1e-6


def hour_task(hours: float) -> Task:
    return Task.plain(0.0, hours)


# Laws, on a robot with everything.

USAGE = {"kilometres": "1.5 km/h", "cycles": "30 cycle/h", "starts": "0.4 start/h", "operating": 0.5}
Q10 = {"model": "q10", "reference_temperature": "25 degC"}
EVERYTHING = {
    "motor": {
        "life": {"distribution": "weibull", "scale": "300 h", "shape": 1.7},
        "scaling": "hazard",
        "acceleration": Q10,
        "initial_exposure": "50 h",
        "duty": 0.3,
        "quantity": 3,
        "required": 2,
    },
    "wheel": {
        "life": {"distribution": "weibull", "scale": "90 km", "shape": 2.2},
        "clock": "kilometres",
        "acceleration": {"model": "cubic_load"},
        "initial_exposure": "12 km",
        "quantity": 2,
    },
    "camera": {"rate": "2e-3 /h", "life": {"distribution": "lognormal", "log_deviation": 0.8}, "monitored": True},
    "lidar": {"rate": "5e-3 /h", "acceleration": [Q10], "initial_exposure": "100 h", "duty": 0.0},
    "gripper": {
        "rate": "1e-4 /cycle",
        "clock": "cycles",
        "acceleration": {"model": "cubic_load"},
        "initial_exposure": "900 cycle",
    },
    "seal": {
        "life": {"distribution": "rayleigh", "scale": "800 h"},
        "clock": "calendar",
        "scaling": "hazard",
        "acceleration": Q10,
    },
    "relay": {"rate": "1e-2 /start", "clock": "starts", "quantity": 2, "required": 1},
}
FUNCTIONS = {
    "drive": {"series": ["wheel", "motor", "relay"]},
    "see": {"parallel": ["camera", "lidar"]},
    "lift": {"series": ["gripper", "relay", {"k_of_n": {"k": 2, "of": ["motor", "camera", "seal"]}}]},
}
LAWFUL = robot(EVERYTHING, functions=FUNCTIONS, usage=USAGE)
PLANT = Plant(LAWFUL)
VIEWS = outlooks(PLANT, ExposureIntegrator(LAWFUL), Ledger.new(LAWFUL))
OUTLOOK = VIEWS["sensor_based"]
ALL_UNITS = frozenset(PLANT.units)
ALL_WORK = lived(LAWFUL, Knowledge(working=ALL_UNITS))

BY_AGE = lived(
    robot(
        {name: {key: value for key, value in part.items() if key != "scaling"} for name, part in EVERYTHING.items()},
        functions=FUNCTIONS,
        usage=USAGE,
    )
)

stresses = st.fixed_dictionaries(
    {},
    optional={
        "temperature": st.floats(-20, 90),
        "motor/temperature": st.floats(-20, 90),
        "load": st.floats(0, 2),
        "wheel/load": st.floats(0, 2),
    },
)
functions = st.sets(st.sampled_from(list(FUNCTIONS)), max_size=3).map(lambda names: tuple(sorted(names)))
legs = st.builds(
    Leg,
    duration=st.one_of(st.floats(1e-6, 60), st.just(0.0)),
    distance=st.one_of(st.floats(1e-3, 4e4), st.just(0.0)),
    cycles=st.one_of(st.none(), st.floats(0, 2000)),
    starts=st.one_of(st.none(), st.floats(0, 20)),
    functions=functions,
    stresses=stresses,
)
tasks = st.lists(legs, min_size=1, max_size=4).map(lambda many: Task(tuple(many)))


def alike(one: Completion, other: Completion) -> None:
    assert one.probability == exact(other.probability)
    assert one.failure == exact(other.failure)
    assert one.probability + one.failure == pytest.approx(1, rel=1e-14)


@pytest.mark.parametrize("view", VIEWS)
def test_an_empty_task_is_always_completed(view: Any) -> None:
    for task in (
        Task(()),
        Task((Leg(0.0, cycles=0.0, starts=0.0),)),
        Task((Leg(0.0, functions=("drive",)), Leg(0.0, functions=("lift", "see")))),
    ):
        assert completion(VIEWS[view], task) == Completion(1.0, 0.0)


@given(tasks, st.data())
def test_splitting_a_leg_changes_nothing(task: Task, data: st.DataObject) -> None:
    i = data.draw(st.integers(0, len(task.legs) - 1))
    share = data.draw(st.sampled_from([0.0, 0.5, 0.25, 1e-3, 1.0]))

    def part(leg: Leg, of: float) -> Leg:
        sums = {name: getattr(leg, name) for name in ("duration", "distance", "cycles", "starts")}
        return replace(leg, **{name: total * of for name, total in sums.items() if total is not None})

    leg = task.legs[i]
    split = Task((*task.legs[:i], part(leg, share), part(leg, 1 - share), *task.legs[i + 1 :]))
    for outlook in (OUTLOOK, VIEWS["nominal"], ALL_WORK):
        alike(completion(outlook, split), completion(outlook, task))


@given(tasks, st.integers(0, 4))
def test_a_leg_of_nothing_changes_nothing(task: Task, i: int) -> None:
    """Where it needs what another leg needs."""
    i = min(i, len(task.legs) - 1)
    nothing = Leg(0.0, cycles=0.0, starts=0.0, functions=task.legs[i].functions, stresses={"temperature": 80.0})
    more = Task((*task.legs[:i], nothing, *task.legs[i:]))
    alike(completion(OUTLOOK, more), completion(OUTLOOK, task))


@given(tasks, st.data())
def test_a_longer_task_never_helps(task: Task, data: st.DataObject) -> None:
    i = data.draw(st.integers(0, len(task.legs) - 1))
    name = data.draw(st.sampled_from(["duration", "distance", "cycles", "starts"]))
    leg = task.legs[i]
    assume(getattr(leg, name) is not None)
    longer = replace(leg, **{name: getattr(leg, name) + data.draw(st.floats(0, 100))})
    short, long = (completion(OUTLOOK, Task((*task.legs[:i], one, *task.legs[i + 1 :]))) for one in (leg, longer))
    assert long.probability <= short.probability * (1 + 1e-13)
    assert long.failure >= short.failure * (1 - 1e-13)


@given(tasks, legs)
def test_another_leg_never_helps(task: Task, leg: Leg) -> None:
    """Where all is known to work: another function tells that what it needs works now."""
    short, long = completion(ALL_WORK, task), completion(ALL_WORK, Task((*task.legs, leg)))
    assert long.probability <= short.probability * (1 + 1e-13)
    assert long.failure >= short.failure * (1 - 1e-13)


@given(tasks, st.data())
def test_another_function_never_helps(task: Task, data: st.DataObject) -> None:
    i = data.draw(st.integers(0, len(task.legs) - 1))
    leg = task.legs[i]
    assume(leg.functions)
    more = replace(leg, functions=tuple(sorted({*leg.functions, data.draw(st.sampled_from(list(FUNCTIONS)))})))
    few, many = (completion(ALL_WORK, Task((*task.legs[:i], one, *task.legs[i + 1 :]))) for one in (leg, more))
    assert many.probability <= few.probability * (1 + 1e-13)
    assert many.failure >= few.failure * (1 - 1e-13)


@given(tasks, st.data())
def test_more_stress_within_the_task_never_helps(task: Task, data: st.DataObject) -> None:
    """Of models that are monotone: warmer, or more load."""
    i = data.draw(st.integers(0, len(task.legs) - 1))
    leg = task.legs[i]
    name = data.draw(st.sampled_from(["temperature", "load"]))
    low = data.draw(st.floats(0, 40) if name == "temperature" else st.floats(0, 1))
    less, more = (
        completion(
            OUTLOOK, Task((*task.legs[:i], replace(leg, stresses={**leg.stresses, name: value}), *task.legs[i + 1 :]))
        )
        for value in (low, low * (1 + data.draw(st.floats(0, 1))))
    )
    assert more.probability <= less.probability * (1 + 1e-13)
    assert more.failure >= less.failure * (1 - 1e-13)
    nominal = completion(VIEWS["nominal"], task)
    without = completion(VIEWS["nominal"], Task(tuple(replace(one, stresses={}) for one in task.legs)))
    assert nominal == without  # which asks for no stresses


@given(st.lists(legs, min_size=2, max_size=4), st.randoms(use_true_random=False), functions)
def test_the_order_of_legs_counts_only_where_it_should(
    many: list[Leg], rng: random.Random, functions: tuple[str, ...]
) -> None:
    """Legs with the same functions only add up, except where stress weighs a hazard that changes with age."""
    same_needs = [replace(leg, functions=functions) for leg in many]
    shuffled = rng.sample(same_needs, len(same_needs))
    alike(completion(BY_AGE, Task(tuple(shuffled))), completion(BY_AGE, Task(tuple(same_needs))))


def test_the_order_of_legs_counts_where_functions_differ() -> None:
    """First a or b, then a: the end state of a alone; the other way round b may stand in for it."""
    outlook = as_designed(Plant(a_or_b(0.1)))
    p = mp.exp(-mpf(0.2))
    same(completion(outlook, Task(THEN_EITHER.legs[::-1])), p, 1 - p)
    assert completion(outlook, THEN_EITHER).probability > float(p)


def test_the_order_of_stresses_counts_where_they_weigh_an_ageing_hazard() -> None:
    """A Rayleigh hazard, an hour at four times the rate and one at once: 4·1 + 1·3 or 1·1 + 4·3."""
    wear = {"life": {"distribution": "weibull", "scale": "10 h", "shape": 2}, "scaling": "hazard", "acceleration": Q10}
    outlook = lived(robot({"part": wear}))
    hot, cool = (Leg(1.0, stresses={"temperature": value}) for value in (45.0, 25.0))
    for order, ahead in (((hot, cool), 7), ((cool, hot), 13)):
        same(completion(outlook, Task(order)), mp.exp(-mpf(ahead) / 100), -mp.expm1(-mpf(ahead) / 100))


# PoTC(A, then B) = PoTC(A) · PoTC(B | A succeeded).


def repeated(outlook: Outlook, plan: Sequence[Task], count: int, **more: Any) -> np.ndarray:
    return np.concatenate(list(repetitions(outlook, plan, count, **more)), axis=1)


@given(tasks, st.integers(2, 5))
def test_repetitions_are_conditional_on_those_before(task: Task, count: int) -> None:
    for outlook in (OUTLOOK, VIEWS["nominal"]):
        found = repeated(outlook, [task], count)
        whole = completion(outlook, Task(task.legs * count))
        assume(whole.probability > 1e-250)
        assert np.prod(found[0]) == exact(whole.probability)
        before = np.cumprod([1.0, *found[0][:-1]])
        assert np.sum(before * found[1]) == exact(whole.failure)
        assert found.sum(axis=0) == pytest.approx(np.ones(count), rel=1e-13)
        alike(Completion(*found[:, 0]), completion(outlook, task))


@given(st.lists(tasks, min_size=1, max_size=4))
def test_a_task_that_follows_is_conditional_on_those_before(plan: list[Task]) -> None:
    """Where all is known to work: else another function tells at its task what it would have told before."""
    found = following(ALL_WORK, plan)
    whole = completion(ALL_WORK, Task(tuple(leg for task in plan for leg in task.legs)))
    assume(whole.probability > 1e-250)
    assert math.prod(one.probability for one in found) == exact(whole.probability)
    before = np.cumprod([1.0, *(one.probability for one in found[:-1])])
    assert float(np.sum(before * [one.failure for one in found])) == exact(whole.failure)


@given(tasks, st.integers(1, 4))
def test_a_task_that_follows_itself_is_repeated(task: Task, count: int) -> None:
    once = following(OUTLOOK, [task] * count)
    again = repeated(OUTLOOK, [task], count)
    assume(again.shape[1] == count)
    assume(again[0].min() > 1e-250)
    for one, (probability, failure) in zip(once, again.T, strict=True):
        alike(one, Completion(probability, failure))


def test_what_follows_nothing_is_as_it_is() -> None:
    task = Task((hour("drive"), hour("see")))
    empty, first, second = following(OUTLOOK, [Task(()), task, Task(())])
    assert empty == second == Completion(1.0, 0.0)
    alike(first, completion(OUTLOOK, task))


def test_repetitions_of_exponential_parts_in_series_are_alike() -> None:
    outlook = as_designed(Plant(robot({"a": {"rate": "1e-5 /h"}, "b": {"rate": "3e-15 /h"}})))
    found = repeated(outlook, [Task.plain(10.0, 0.5), Task.plain(0.0, 1.5)], 1000)
    hazard = 2 * (mpf(1e-5) + mpf(3e-15))
    assert found.shape == (2, 1000)
    assert found[0] == pytest.approx(np.full(1000, float(mp.exp(-hazard))), rel=1e-14)
    assert found[1] == pytest.approx(np.full(1000, float(-mp.expm1(-hazard))), rel=1e-12)


def test_parts_that_must_work_are_as_good_however_often() -> None:
    """A million hours at 0.002 /h: that all succeed is e^-2000, which no number holds; the next is e^-0.002 still."""
    outlook = as_designed(Plant(robot({"a": {"rate": "1e-3 /h"}, "b": {"rate": "1e-3 /h"}})))
    found = repeated(outlook, [hour_task(1.0)], 1_000_000)
    assert found.shape == (2, 1_000_000)
    assert found[0] == pytest.approx(np.full(1_000_000, math.exp(-0.002)), rel=1e-12)
    assert found[1] == pytest.approx(np.full(1_000_000, -math.expm1(-0.002)), rel=1e-12)


def test_what_no_number_can_tell_is_not_told() -> None:
    """Of a pair one is left in the end: e^-1 each time; 2 e^-k that it has come so far is too little from 669 on."""
    found = repeated(as_designed(Plant(a_or_b(1.0))), [Task((hour("either"),))], 2000)
    assert 660 < found.shape[1] < 680
    assert found[0, 100:] == pytest.approx(np.full(found.shape[1] - 100, math.exp(-1)), rel=1e-12)


def test_what_has_failed_is_told_each_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robophm.health.mission._AT_ONCE", 1)
    outlook = as_designed(Plant(a_or_b(1.0)), Knowledge(failed=frozenset({"a", "b"})))
    assert repeated(outlook, [Task((hour("either"),))], 5).tolist() == [[0.0] * 5, [1.0] * 5]


@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_repetitions_of_a_weibull_part(scaling: str) -> None:
    """H of repetition k of one hot and one cool hour, shape 2: by age squares of effective ages, else odd numbers."""
    wear = {"life": {"distribution": "weibull", "scale": "100 h", "shape": 2}, "scaling": scaling, "acceleration": Q10}
    outlook = lived(robot({"part": wear}))
    task = Task(tuple(Leg(1.0, stresses={"temperature": value}) for value in (45.0, 25.0)))
    found = repeated(outlook, [task], 50)
    for k, (probability, failure) in enumerate(found.T):
        ahead = (5 * (k + 1)) ** 2 - (5 * k) ** 2 if scaling == "age" else 4 * (4 * k + 1) + (4 * k + 3)
        same(Completion(probability, failure), mp.exp(-mpf(ahead) / 10**4), -mp.expm1(-mpf(ahead) / 10**4))


def test_a_spare_may_have_failed_long_before() -> None:
    """Repeating "a or b": what is known is only that one of the two works, R(k + 1)/R(k) of the pair."""
    outlook = as_designed(Plant(a_or_b(0.01)))
    found = repeated(outlook, [Task((hour("either"),))], 200)

    def q(t: int) -> mpf:
        return mp.expm1(-mpf(0.01) * t) ** 2

    for k, (probability, failure) in enumerate(found.T):
        same(Completion(probability, failure), (1 - q(k + 1)) / (1 - q(k)), (q(k + 1) - q(k)) / (1 - q(k)))


@pytest.mark.parametrize("scaling", ["age", "hazard"])
def test_a_gap_between_repetitions_is_of_the_calendar(scaling: str) -> None:
    seal = {"life": {"distribution": "weibull", "scale": "1000 h", "shape": 2}, "clock": "calendar", "scaling": scaling}
    outlook = as_designed(Plant(robot({"seal": seal, "motor": {"rate": "1e-3 /h"}})))
    found = repeated(outlook, [hour_task(2.0)], 5, gap=6.0)
    for k, (probability, failure) in enumerate(found.T):
        start = 8 * k  # its last two hours are the task's, all that is before is known to be survived
        ahead = mpf((start + 2) ** 2 - max(start - 6, 0) ** 2) / 10**6 + 2 * mpf(0.001)
        same(Completion(probability, failure), mp.exp(-ahead), -mp.expm1(-ahead))


def test_a_hazard_that_stress_weighs_leg_by_leg_is_gathered_leg_by_leg() -> None:
    """A silent spare of shape 3, hot in the first leg of each round: its chance to live still is a plain sum."""
    wear = {"life": {"distribution": "weibull", "scale": "40 h", "shape": 3}, "scaling": "hazard", "acceleration": Q10}
    outlook = lived(robot({"a": {"rate": "0.02 /h"}, "b": wear}, diagram={"parallel": ["a", "b"]}))
    legs = tuple(Leg(1.0, stresses={"temperature": value}) for value in (55.0, 25.0))
    found = repeated(outlook, [Task(legs)], 8)

    def works(k: int) -> mpf:
        hazard = mp.fsum((8 if i % 2 == 0 else 1) * ((i + 1) ** 3 - i**3) for i in range(2 * k)) / mpf(40) ** 3
        return 1 - mp.expm1(-hazard) * mp.expm1(-2 * k * mpf(0.02))

    for k, (probability, failure) in enumerate(found.T):
        same(Completion(probability, failure), works(k + 1) / works(k), 1 - works(k + 1) / works(k))


def test_no_legs_cannot_be_repeated() -> None:
    with pytest.raises(DesignError, match="no legs; expected tasks that take time"):
        next(repetitions(OUTLOOK, [Task(())], 3))


def test_many_repetitions_in_turns_are_as_in_one(monkeypatch: pytest.MonkeyPatch) -> None:
    task = Task((hour("drive", distance=300.0), hour("lift", stresses={"temperature": 50.0})))
    whole = repeated(OUTLOOK, [task], 60)
    monkeypatch.setattr("robophm.health.mission._AT_ONCE", 1)
    turns = list(repetitions(OUTLOOK, [task], 60))
    assert len(turns) > 10
    assert np.concatenate(turns, axis=1) == pytest.approx(whole, rel=1e-13)


# What is known.


def test_units_of_a_task_file_change_nothing() -> None:
    """m or km, s or h, °C or K."""
    texts = [
        "{distance: 2500 m, speed: 0.5 m/s, stresses: {temperature: 40 degC}, functions: [drive, see]}",
        "{distance: 2.5 km, speed: 1.8 km/h, stresses: {temperature: 313.15 K}, functions: [see, drive]}",
        "{distance: 250000 cm, duration: 5000 s, stresses: {temperature: 40 degC}, functions: [drive, see, see]}",
        "{speed: 50 cm/s, duration: 5e6 ms, stresses: {temperature: 104 degF}, functions: [drive, see]}",
    ]
    found = [
        completion(OUTLOOK, parse_plan(f"schema_version: 1\ntasks:\n  - {text}\n", LAWFUL).tasks[0]) for text in texts
    ]
    for other in found[1:]:
        alike(other, found[0])


def test_a_stated_stress_below_a_part_is_nearer() -> None:
    task = Task((hour("see", stresses={"temperature": 45.0, "lidar/temperature": 35.0}),))
    parts = {"lidar": {"rate": "5e-3 /h", "acceleration": Q10}}
    outlook = lived(robot(parts, functions={"see": "lidar"}))
    assert completion(outlook, task).probability == exact(mp.exp(-2 * mpf(5e-3)))


def test_offsets_of_parts_are_added_to_a_stated_stress() -> None:
    """A sensor at 35 °C, one part 10 K above it, one 20 K by its own; what is not stated is as of late."""
    hot = {"temperature": {"topic": "/t", "field": "c", "unit": "degC"}}
    part = {"rate": "1e-3 /h", "acceleration": Q10}
    own = {"temperature": {**hot["temperature"], "offset": "20 K"}}
    parts = {"a": part, "b": {**part, "offsets": {"temperature": "10 K"}}, "c": {**part, "signals": own}}
    outlook = lived(robot(parts, signals=hot))
    stated = Task((Leg(1.0, stresses={"temperature": 35.0}), Leg(1.0)))
    expected = mpf(0.001) * (2 + 4 + 8 + 3)
    same(completion(outlook, stated), mp.exp(-expected), -mp.expm1(-expected))
    nearest = Task((Leg(1.0, stresses={"temperature": 35.0, "b/temperature": 5.0}),))
    expected = mpf(0.001) * (2 + mpf("0.5") + 8)
    same(completion(outlook, nearest), mp.exp(-expected), -mp.expm1(-expected))


def test_of_two_inputs_what_is_not_stated_is_as_of_late() -> None:
    """At 45 °C for the last ten minutes and a stated load of 2: 4 · 8; at design the nominal view stays."""
    hot = {"temperature": {"topic": "/t", "field": "c", "unit": "degC", "max_age": "1 h"}}
    design = robot({"a": {"rate": "1e-3 /h", "acceleration": [Q10, {"model": "cubic_load"}]}}, signals=hot)
    exposure, ledger = ExposureIntegrator(design), Ledger.new(design)
    ledger.started = 0
    exposure.integrate(ledger, [Sample(0, "/t.c", 45.0)], 30 * SECOND)
    views = outlooks(Plant(design), exposure, ledger)
    for stresses, factor in (({"load": 2.0}, 32), ({}, 4), ({"load": 2.0, "temperature": 25.0}, 8)):
        ahead = Task((Leg(1.0, stresses=stresses),))
        assert completion(views["sensor_based"], ahead).failure == exact(-mp.expm1(-mpf(0.001) * factor))
        assert completion(views["nominal"], ahead).failure == exact(-mp.expm1(-mpf(0.001)))
    as_stated = outlooks(Plant(design), exposure, ledger, future="nominal")["sensor_based"]
    for stresses, factor in (({"load": 2.0}, 8), ({}, 1)):  # what is not stated is nominal, not as of late
        ahead = Task((Leg(1.0, stresses=stresses),))
        assert completion(as_stated, ahead).failure == exact(-mp.expm1(-mpf(0.001) * factor))


@pytest.mark.parametrize("age", [0.0, 40.0])
@pytest.mark.parametrize("monitored", [True, False])
def test_a_part_reported_failed(age: float, monitored: bool) -> None:
    """A single point of failure: 0. One of a pair: the other alone, as old as it is, works now."""
    rate = 0.02
    design = a_or_b(rate, age, monitored=monitored)
    outlook = as_designed(Plant(design), Knowledge(failed=frozenset("b")))
    assert completion(outlook, Task((hour("either"),))).failure == exact(-mp.expm1(-mpf(rate)))
    same(completion(outlook, THEN_EITHER), mp.exp(-2 * mpf(rate)), -mp.expm1(-2 * mpf(rate)))
    other = as_designed(Plant(design), Knowledge(failed=frozenset("a")))
    assert completion(other, THEN_EITHER) == Completion(0.0, 1.0)
    assert completion(other, Task((hour("either"),))).probability == exact(mp.exp(-mpf(rate)))
    assert completion(other, Task((hour("either"), hour("a")))) == Completion(0.0, 1.0)


def test_a_broken_arm_zeroes_only_what_needs_it() -> None:
    parts = {"arm": {"rate": "1 /h"}, "wheels": {"rate": "1e-3 /h"}}
    design = robot(parts, functions={"drive": "wheels", "lift": "arm"})
    outlook = as_designed(Plant(design), Knowledge(failed=frozenset({"arm"})))
    assert completion(outlook, Task(())) == Completion(1.0, 0.0)  # nothing to do needs no arm
    drive = Task((hour("drive"), hour("drive")))
    same(completion(outlook, drive), mp.exp(-mpf(2e-3)), -mp.expm1(-mpf(2e-3)))
    for broken in (Task((hour("drive"), hour("lift"))), Task((hour("lift"),)), Task((Leg(1.0),))):
        assert completion(outlook, broken) == Completion(0.0, 1.0)
        assert following(outlook, [drive, broken])[1] == Completion(0.0, 1.0)
        assert repeated(outlook, [broken], 3).tolist() == [[0.0] * 3, [1.0] * 3]


def test_two_of_three_that_are_told_apart() -> None:
    """One of three motors is known to have failed: both others must outlive the task, and work now by that."""
    motor = {"rate": "0.01 /h", "quantity": 3, "required": 2, "initial_exposure": "70 h"}
    design = robot({"motor": motor})
    p, p0 = mp.exp(-mpf(0.05)), mp.exp(-mpf(0.7))
    task = hour_task(5.0)
    found = completion(as_designed(Plant(design), Knowledge(failed=frozenset({"motor[2]"}))), task)
    same(found, p**2, 1 - p**2)
    found = completion(as_designed(Plant(design), Knowledge(working=frozenset({"motor[2]"}))), task)
    other = 1 - (1 - p0) ** 2  # of the other two at least one works now
    end = p * (1 - (1 - p0 * p) ** 2) + (1 - p) * (p0 * p) ** 2
    same(found, end / other, 1 - end / other)
    found = completion(as_designed(Plant(design), Knowledge(failed=frozenset({"motor[1]", "motor[2]"}))), task)
    assert found == Completion(0.0, 1.0)


# What a task hangs on.


@pytest.mark.parametrize("seed", range(0, 40, 4))
def test_a_component_that_cannot_fail(seed: int) -> None:
    """Without its failures, as if it were known to work and its rate were next to nothing."""
    case = Case.draw(seed)
    case.knowledge = Knowledge()
    design = case.design()
    outlook = lived(design)
    task = Task(tuple(case.legs))
    found = {one.path: one for one in deciding(outlook, task)}
    whole = completion(outlook, task).failure
    for part in case.parts:
        immortal = Case([replace(one) for one in case.parts], case.functions, case.legs)
        for one in immortal.parts:
            if one.name == part.name:
                one.hazard = lambda age: mpf(0)  # type: ignore[method-assign]
        failure, _ = immortal.expected(design, nominal=False)
        if part.name in found:
            assert found[part.name].failure_without == exact(failure, 1e-12)
            assert found[part.name].share == pytest.approx(
                float(max(1 - failure / mpf(whole), 0) if whole else 0), abs=1e-10
            )
        else:
            assert failure == exact(whole)
    shares = [one.share for one in deciding(outlook, task)]
    assert shares == sorted(shares, reverse=True)


def test_a_list_multiplies_also_where_its_tasks_need_different_functions() -> None:
    """All functions of the list work now: the product over its tasks is that all are completed, whatever they share."""
    ages = {"a": (0.1, 5), "b": (0.2, 5), "c": (0.3, 3)}
    parts = {name: {"rate": f"{rate} /h", "initial_exposure": f"{age} h"} for name, (rate, age) in ages.items()}
    functions = {"ab": {"parallel": ["a", "b"]}, "bc": {"parallel": ["b", "c"]}}
    text = {"schema_version": 1, "name": "R", "components": parts, "functions": functions}
    outlook = as_designed(Plant(parse(json.dumps(text))))
    first, second = (Task((Leg(1.0, functions=(name,)),)) for name in functions)
    one, two = following(outlook, [first, second])
    both = completion(outlook, Task((*first.legs, *second.legs)))
    assert one.probability * two.probability == pytest.approx(both.probability, rel=1e-14)
