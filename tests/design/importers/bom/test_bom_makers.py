"""Imported motor controllers against what a maker of such says of its own.

maxon's support pages (Reliability analysis, failure rate, MTBF) state 300,000 to 1,200,000 h as typical of its motor
controllers, calculated by handbooks; for which place is not said, and calculations are usually for a benign one.
"""

import pytest

from robophm.design.importers.bom import import_bom, rate_range, total_rate
from robophm.design.importers.bom.assumptions import Assumptions

TYPICAL = (300_000, 1_200_000)  # h
CONTROLLERS = ["odrive31.csv", "odrive34_24.csv", "vesc412.ods"]


def imported(shared, tmp_path, name, quality, environment="indoor"):
    assumed = Assumptions(quality=quality)
    found = import_bom(shared / "boms" / name, tmp_path / "robot.yaml", assumptions=assumed, environment=environment)
    assert not found.of_state("needs a rate")
    return found


@pytest.mark.parametrize("name", CONTROLLERS)
def test_the_range_of_an_unsaid_quality_reaches_into_what_a_maker_states(name, shared, tmp_path):
    """In ground, benign: its best end is within the maker's range, and all else of it is below."""
    low, high = TYPICAL
    slowest, fastest = rate_range(imported(shared, tmp_path, name, None).parts)
    assert low < 1 / slowest < high
    assert 1 / fastest < low / 2


@pytest.mark.parametrize("name", CONTROLLERS)
def test_known_pedigree_is_within_what_a_maker_states(name, shared, tmp_path):
    low, high = TYPICAL
    assert low < 1 / total_rate(imported(shared, tmp_path, name, "known pedigree").parts) < high


@pytest.mark.parametrize("name", CONTROLLERS)
def test_in_a_vehicle_no_end_of_it_is(name, shared, tmp_path):
    """That the maker's range is of a benign place is an assumption that this test holds to be seen."""
    slowest, _ = rate_range(imported(shared, tmp_path, name, None, "vehicle").parts)
    assert 1 / slowest < TYPICAL[0] / 2
