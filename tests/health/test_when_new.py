"""What a design promises when new, level by level, in closed form; and the same by chance."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robophm.design.file import parse
from robophm.health.monte_carlo import survival_by_monte_carlo
from robophm.health.outlooks import as_designed, nominal_outlook
from robophm.health.plant import Plant
from robophm.health.when_new import hazard_rates, nominal_figures

ROBOT = parse("""
schema_version: 1
name: R
usage: {operating: 0.5}
components:
  board: {rate: unknown}
modules:
  pair:
    components:
      left: {rate: 1e-3 /h}
      right: {rate: 2e-3 /h}
    diagram: {parallel: [left, right]}
  lamps:
    components:
      lamp: {rate: 1e-3 /h, quantity: 3, life: {distribution: weibull, shape: 2}}
""")
HOURS = 400.0
SAMPLES = 200_000


def test_each_level_in_closed_form() -> None:
    found = {one.path: one for one in nominal_figures(Plant(ROBOT), HOURS)}
    assert list(found) == ["", "pair", "lamps"]
    a, b = 1e-3, 2e-3
    left, right, both = (math.exp(-rate * HOURS) for rate in (a, b, a + b))
    works = left + right - both
    density = a * left + b * right - (a + b) * both
    pair = found["pair"]
    assert pair.reliability == pytest.approx(works, rel=1e-13)
    assert pair.unreliability == pytest.approx((1 - left) * (1 - right), rel=1e-13)
    assert pair.hazard_rate == pytest.approx(density / works, rel=1e-12)
    assert pair.mean_time_to_failure == pytest.approx(2 * (1 / a + 1 / b - 1 / (a + b)), rel=1e-6)  # on half the time
    scale = 1000 / math.gamma(1.5)
    lamps = found["lamps"]
    assert lamps.reliability == pytest.approx(math.exp(-3 * (HOURS / scale) ** 2), rel=1e-13)
    assert lamps.hazard_rate == pytest.approx(3 * 2 * HOURS / scale**2, rel=1e-12)
    whole = found[""]
    assert whole.reliability == pytest.approx(pair.reliability * lamps.reliability, rel=1e-13)
    assert whole.unknown is not None
    assert (pair.unknown, lamps.unknown) == (None, None)


def test_hazard_rates_now_of_levels_and_of_components_with_all_their_parts() -> None:
    plant = Plant(ROBOT)
    new = hazard_rates(as_designed(plant))
    assert new == pytest.approx(
        {"": 0.0, "pair": 0.0, "lamps": 0.0, "pair/left": 1e-3, "pair/right": 2e-3, "lamps/lamp": 0.0, "board": 0.0},
        abs=1e-300,
    )
    aged = hazard_rates(nominal_outlook(plant, np.full(len(ROBOT.modes), 50.0)))
    lamps = 3 * 2 * 50.0 / (1000 / math.gamma(1.5)) ** 2
    assert aged["lamps/lamp"] == aged["lamps"] == pytest.approx(lamps, rel=1e-12)
    assert aged["pair/right"] == pytest.approx(2e-3, rel=1e-12)


def test_by_chance_it_survives_as_often() -> None:
    (exact, *_) = nominal_figures(Plant(ROBOT), HOURS)
    found = survival_by_monte_carlo(ROBOT, HOURS, SAMPLES, seed=2)
    assert found.probability == pytest.approx(exact.reliability, abs=sure(exact.reliability))
    assert found == survival_by_monte_carlo(ROBOT, HOURS, SAMPLES, seed=2)
    older = parse("schema_version: 1\nname: R\ncomponents: {a: {rate: 1e-3 /h, initial_exposure: 100 h}}\n")
    aged = survival_by_monte_carlo(older, 100.0, SAMPLES)
    assert aged.probability == pytest.approx(math.exp(-0.2), abs=sure(math.exp(-0.2)))  # what it had behind it counts


def sure(p: float) -> float:
    """Four standard deviations."""
    return 4 * math.sqrt(p * (1 - p) / SAMPLES)
