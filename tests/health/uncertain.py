"""What the tests of uncertain rates and loads share.

A rate with a gamma distribution of shape k and mean k/b makes the predictive survival of a part known to have lived a
hours L(a + t)/L(a), with L(x) = (b/(b + x))^k: Lomax.
"""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.drawn_rates import draw_rates
from robophm.health.future import Future
from robophm.health.ledger import Ledger, Step
from robophm.health.outlooks import nominal_outlook
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import (
    Interval,
    predictive_life,
)

Array = npt.NDArray[np.float64]
DRAWS = 20_000
RATE, FAILURES = 1e-3, 2.0
B = FAILURES / RATE
GAMMA = {"rate": f"{RATE} /h", "uncertainty": {"failures": FAILURES}}
WEAR = {"distribution": "weibull", "scale": "1000 h", "shape": 3}
LOGNORMAL = {"distribution": "lognormal", "log_mean": 7.0, "log_deviation": 0.5}
LEVELS = (0.95, 0.5, 0.05)


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def aged(design: Robot, *hours: float) -> Outlook:
    return nominal_outlook(Plant(design), np.array(hours))


def L(hours: float) -> float:
    """E[exp(−rate·hours)]."""
    return (B / (B + hours)) ** FAILURES


def near(value: Any, rel: float = 1e-3) -> Any:
    return pytest.approx(value, rel=rel, abs=0)


def life(outlook: Outlook, futures: list[Future] | None = None, draws: int = DRAWS) -> Interval:
    ratios = draw_rates(outlook.plant, draws, 0)
    return predictive_life(outlook, outlook.plant.robot.diagram, ratios, futures or [outlook.future])


def ratios_of(error_factor: float) -> tuple[Array, Array]:
    """Nodes and weights of E over a lognormal ratio of mean 1."""
    z, weight = np.polynomial.hermite_e.hermegauss(120)
    deviation = math.log(error_factor) / 1.6448536269514722
    return np.exp(deviation * z - deviation**2 / 2), weight / weight.sum()


def steady(outlook: Outlook, factor: float) -> Future:
    plant = outlook.plant
    return Future.steady("steady", plant, np.full(len(plant.robot.modes), factor), plant.usage, 1.0)


def history(plant: Plant, factors: list[float], operating: float = 1.0) -> Ledger:
    """A past of hours in which all modes had these stress factors."""
    ledger, n = Ledger.new(plant.robot), len(plant.robot.modes)
    ledger.history = [
        Step(i, 1.0, operating, np.full(n, operating), np.full(n, operating * factor), {})
        for i, factor in enumerate(factors)
    ]
    return ledger


PLANT = Plant(robot({"a": {"rate": "1e-3 /h"}}))
