"""The paper's robot: the guide's published figures, the exact ones beside them, and every row of Table 17."""

import math
from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML

from robophm.blocks.diagram import Parallel
from robophm.design.file import load
from robophm.design.importers.legacy.figures import legacy_rate, legacy_reliability
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

OTA = Path(__file__).parents[2] / "examples" / "ota"

# Use-case guide of the 2020 tool, tables 15-17: λ [1/h] and R at 1000 h.
GUIDE = {
    "Power": (4.62653527447025e-4, 0.6296107375618971),
    "Sensing": (8.238437533333333e-6, 0.9917954053917838),
    "Communication": (1.06245744208149e-5, 0.989431667013337),
    "Mobility": (4.7201147504e-5, 0.9538955045917938),
    "Computation": (1.15e-7, 0.9998850066122466),
}
GUIDE_SYSTEM = (5.288326869051733e-4, 0.589292457145637)
LASER, CAMERA, IPS = 8e-8, 5.88e-9, 8.1811842e-6


@pytest.fixture(scope="module")
def guide():
    return load(OTA / "guide.yaml")


def test_published_figures_come_out_of_the_legacy_roll_up(guide):
    for module in guide.modules:
        rate, reliability = GUIDE[module.path]
        assert legacy_rate(module) == pytest.approx(rate, rel=1e-9)
        assert legacy_reliability(module, 1000) == pytest.approx(reliability, rel=1e-9)
    assert legacy_rate(guide) == pytest.approx(GUIDE_SYSTEM[0], rel=1e-9)
    assert legacy_reliability(guide, 1000) == pytest.approx(GUIDE_SYSTEM[1], rel=1e-9)


def test_series_modules_are_exactly_as_published(guide):
    new = as_designed(Plant(guide))
    for module in guide.modules:
        if module.path != "Sensing":
            state = new.survival_curve(module.diagram, np.array([1000.0]))
            assert state.works[0] == pytest.approx(GUIDE[module.path][1], rel=1e-9)
            assert state.density[0] / state.works[0] == pytest.approx(GUIDE[module.path][0], rel=1e-9)


def test_the_redundant_pair_has_no_constant_rate(guide):
    """Camera ∥ laser by its closed form: f/p at 1000 h, and 1/MTTF, which is not a rate."""
    new = as_designed(Plant(guide))
    pair = Parallel("Sensing/SICK", "Sensing/Camera")
    state = new.survival_curve(pair, np.array([1000.0]))
    a, b = LASER * 1000, CAMERA * 1000
    density = LASER * math.exp(-a) * -math.expm1(-b) + CAMERA * math.exp(-b) * -math.expm1(-a)
    works = math.exp(-a) + math.exp(-b) * -math.expm1(-a)
    assert state.density[0] / state.works[0] == pytest.approx(density / works, rel=1e-12)
    assert state.failed[0] == pytest.approx(math.expm1(-a) * math.expm1(-b), rel=1e-12)
    mean = 1 / LASER + 1 / CAMERA - 1 / (LASER + CAMERA)
    assert new.remaining_life(pair).mean == pytest.approx(mean, rel=1e-9)
    assert 1 / mean == pytest.approx(5.85e-9, rel=1e-3)
    assert legacy_rate(guide.modules[1]) - IPS == pytest.approx(5.73e-8, rel=1e-3)


def test_table_17_is_there_row_by_row(shared: Path):
    rows = YAML(typ="safe").load((shared / "handbook/tables/ota_table17.yaml").read_text())["rows"]
    robot = load(OTA / "robot.yaml")
    parts = {part.path: part for part in robot.all_components()}
    assert len(parts) == len(rows) == 47
    for row in rows:
        words = row["component"].replace("Blocks/", "Block or ").replace("/", " or ")
        whole, single = f"{row['module']}/{row['submodule']}/{words}", f"{row['module']}/{row['submodule']}"
        part = parts.get(whole) or parts[single]
        assert (part.quantity, part.modes[0].rate) == (row["qty"], pytest.approx(row["rate_per_h"], rel=1e-12))


def test_table_17_adds_up():
    """The sums that the paper's rows give by hand; redundancy leaves the laser and the camera out at time zero."""
    robot = load(OTA / "robot.yaml")
    new = as_designed(Plant(robot))
    sums = {"Power": 4.629672e-4, "Communication": 1.7191e-5, "Mobility": 5.52401444e-5, "Computation": 1.15e-7}
    for path, rate in sums.items():
        module = next(module for module in robot.modules if module.path == path)
        assert new.hazard_rate(module.diagram) == pytest.approx(rate, rel=1e-9)
    assert not robot.warnings
