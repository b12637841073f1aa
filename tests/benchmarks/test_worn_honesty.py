"""The chain from a worn robot's samples to what is promised of its task; 1,000 robots are in docs/calibration.md."""

import math

import numpy as np
import pytest
from benchmarks.worn_honesty import DESIGN, ask, tasks_of
from benchmarks.worn_parts import told

from robophm.design.file import parse
from robophm.simulation.worn_robots import LIMITS, WornRobot


def robot(link_at_end: float, task: float) -> WornRobot:
    """One whose link wears evenly to a level in 100 h, all else hardly at all."""
    rng = np.random.default_rng(1)
    hours = np.arange(101.0)
    ends = {"link": link_at_end, "battery": 0.05, "gear": 1.5}
    readings = {name: hours / 100 * end + 0.01 * LIMITS[name] * rng.standard_normal(101) for name, end in ends.items()}
    left = {name: 100.0 * (LIMITS[name] / end - 1) for name, end in ends.items()}
    return WornRobot(readings, 100.0, task, 200.0, {name: 100.0 + rest for name, rest in left.items()})


@pytest.mark.full
def test_what_is_promised_hangs_on_how_worn_a_robot_is():
    design = parse(DESIGN)
    young, old = (ask(design, robot(level, 30.0)) for level in (1.0, 3.8))
    aged = 0.0  # Weibull by mean and shape, from 100 h on; a pair of computers of which nothing is known since new
    for mean, shape in ((133, 2.8), (206, 2.7), (247, 3.4)):
        scale = mean / math.gamma(1 + 1 / shape)
        aged += (130 / scale) ** shape - (100 / scale) ** shape
    pair = [1 - (1 - math.exp(-3e-3 * hours)) ** 2 for hours in (100, 130)]
    assert young.without.probability == pytest.approx(math.exp(-aged - 0.03) * pair[1] / pair[0], rel=1e-3)
    assert young.with_wear.probability > 0.9
    assert old.with_wear.probability < 0.01
    assert old.without == young.without
    assert ask(design, robot(4.4, 30.0)) is None
    scored = tasks_of([young, old], with_wear=True)
    assert scored.failed.tolist() == [False, False]


def test_a_forecast_of_a_part_is_scored_by_its_true_end():
    """A link that reaches 4 at 200 h: by its readings about then, so that it lasts 30 h more, and 150 h it does not."""
    soon, long = (told(robot(2.0, task), "link", ()) for task in (30.0, 150.0))
    assert soon.said
    assert (soon.failed, long.failed) == (False, True)
    assert soon.promised < 0.05
    assert long.promised > 0.9
    assert soon.off == pytest.approx(0.0, abs=0.1)
    assert 0.1 < soon.width < 0.5
