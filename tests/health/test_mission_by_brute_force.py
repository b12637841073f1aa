"""Tasks of legs by random robots: against the sum over all orders of failure."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any, ClassVar

import numpy as np
import pytest
from mpmath import mp, mpf
from tests.cases import each_case

from robophm.blocks.diagram import Block, Unit
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import completion, deciding_components
from robophm.health.outlooks import outlooks
from robophm.health.plant import Plant

from ..structures import works as structure_function
from .missions import exact, lived, robot, same


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
            return structure_function(diagrams[function], state)

        before = np.all([hold(0, function) for need in needs for function in need], axis=0)
        after = np.all([hold(k + 1, function) for k, need in enumerate(needs) for function in need], axis=0)
        c, s = mp.fsum(weight[before & ~after]), mp.fsum(weight[before & after])
        return (c / (c + s), s / (c + s)) if c + s > 0 else (mpf(1), mpf(0))


def _drawn(block: Block) -> set[str]:
    return {block.name} if isinstance(block, Unit) else set().union(*map(_drawn, block.blocks))


@each_case("seed", range(120))
def test_random_robots_and_tasks(seed: int) -> None:
    case = Case.draw(seed)
    design = case.design()
    views = outlooks(Plant(design), ExposureIntegrator(design), Ledger.new(design), knowledge=case.knowledge)
    for view, outlook in views.items():
        failure, probability = case.expected(design, nominal=view == "nominal")
        same(completion(outlook, Task(tuple(case.legs))), probability, failure)


@each_case("seed", range(0, 40, 4))
def test_a_component_that_cannot_fail(seed: int) -> None:
    """Without its failures, as if it were known to work and its rate were next to nothing."""
    case = Case.draw(seed)
    case.knowledge = Knowledge()
    design = case.design()
    outlook = lived(design)
    task = Task(tuple(case.legs))
    found = {one.path: one for one in deciding_components(outlook, task)}
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
    shares = [one.share for one in deciding_components(outlook, task)]
    assert shares == sorted(shares, reverse=True)
