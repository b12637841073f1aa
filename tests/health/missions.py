"""What the tests of tasks share: robots, what is known of them, and tasks of any kind."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, repetitions
from robophm.health.outlooks import outlooks
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


def a_or_b(rate: float, age: float = 0.0, **more: Any) -> Robot:
    part = {"rate": f"{rate!r} /h", "initial_exposure": f"{age!r} h", **more}
    return robot({"a": part, "b": part}, functions={"a": "a", "either": {"parallel": ["a", "b"]}})


THEN_EITHER = Task((hour("a"), hour("either")))


def hour_task(hours: float) -> Task:
    return Task.plain(0.0, hours)


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


def repeated(outlook: Outlook, plan: Sequence[Task], count: int, **more: Any) -> np.ndarray:
    return np.concatenate(list(repetitions(outlook, plan, count, **more)), axis=1)
