"""Imported motor controllers against what a maker of such says of its own.

maxon's support pages (Reliability analysis, failure rate, MTBF) state 300,000 to 1,200,000 h as typical of its motor
controllers, calculated by handbooks. No such statement was found for autopilots, nor one of the makers of these boards.
"""

import pytest

from robophm.design.importers.bom import import_bom, total_rate
from robophm.design.importers.bom.assumptions import Assumptions

TYPICAL = (300_000, 1_200_000)  # h


@pytest.mark.parametrize("name", ["odrive31.csv", "odrive34_24.csv", "vesc412.ods"])
def test_motor_controllers_are_within_the_range_of_a_makers_statement(name, shared, tmp_path):
    """In ground, benign and of known pedigree; with the handbook's commercial level of 1995 they are far below it."""

    def mean_life(quality):
        assumed = Assumptions(quality=quality)
        found = import_bom(shared / "boms" / name, tmp_path / "robot.yaml", assumptions=assumed, environment="indoor")
        assert not found.of_state("needs a rate")
        return 1 / total_rate(found.parts)

    low, high = TYPICAL
    assert low < mean_life("known pedigree") < high
    assert mean_life(None) < low / 2
