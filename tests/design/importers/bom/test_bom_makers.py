"""Imported boards against what makers of like ones say of their own.

maxon's support pages (Reliability analysis, failure rate, MTBF) state 300,000 to 1,200,000 h as typical of its motor
controllers, calculated by handbooks; for which place is not said, and calculations are usually for a benign one.

Of the Pixhawk, of any other autopilot, and of the OpenCR no maker's statement was found. Boards like them, controllers
with a processor, supplies and plugs in a benign place: 192,796 h at 40 °C (Kontron, manual of the COM Express
miniBaseboard, Bellcore), 227,731 h at 40 °C (Kontron, COM Express Eval Carrier Type 6 manual, section 3.6, Bellcore),
513,550 h at 25 °C (Arduino, Portenta Machine Control data sheet, revision 6, parts count of MIL-HDBK-217F).
"""

import csv

import pytest

from robophm.design.importers.bom import import_bom, rate_range, total_rate
from robophm.design.importers.bom.assumptions import Assumptions

TYPICAL = (300_000, 1_200_000)  # h
CONTROLLER_BOARDS = (192_796, 227_731, 513_550)  # h
CONTROLLERS = ["odrive31.csv", "odrive34_24.csv", "vesc412.ods"]


def imported(shared, tmp_path, name, quality, environment="indoor"):
    assumed = Assumptions(quality=quality)
    found = import_bom(shared / "boms" / name, tmp_path / "robot.yaml", assumptions=assumed, environment=environment)
    assert not found.of_state("needs a rate")
    return found


def mean_lives(parts):
    """The ends of the range of a board's mean life [h], 5 and 95 %."""
    slowest, fastest = rate_range(parts)
    return 1 / fastest, 1 / slowest


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


def test_an_autopilot_is_within_what_makers_state_of_controller_boards(shared, tmp_path):
    """The drafted range of the Pixhawk, indoors, holds all three statements; in the air it holds none."""
    low, high = mean_lives(imported(shared, tmp_path, "pixhawk_fmuv3.xlsx", None).parts)
    assert all(low < stated < high for stated in CONTROLLER_BOARDS)
    pedigree = 1 / total_rate(imported(shared, tmp_path, "pixhawk_fmuv3.xlsx", "known pedigree").parts)
    assert max(CONTROLLER_BOARDS) < pedigree < 1.3 * max(CONTROLLER_BOARDS)  # above all of them, by a fifth or so
    _, highest = mean_lives(imported(shared, tmp_path, "pixhawk_fmuv3.xlsx", None, "flying").parts)
    assert highest < min(CONTROLLER_BOARDS)


def test_the_board_of_a_turtlebot_reaches_into_it(shared, tmp_path):
    """The drafted range of the OpenCR holds two of three; five rows have no rate, so that its ends are bounds."""
    reader = pytest.importorskip("xlrd")
    sheet = reader.open_workbook(shared / "boms" / "opencr.xls").sheets()[0]
    with (saved := tmp_path / "opencr.csv").open("w", newline="") as file:  # as an office program saves it
        csv.writer(file).writerows([[cell.value for cell in sheet.row(row)] for row in range(sheet.nrows)])
    found = import_bom(saved, tmp_path / "robot.yaml", environment="indoor")
    assert len(found.of_state("needs a rate")) == 5
    low, high = mean_lives(found.parts)
    assert [low < stated < high for stated in CONTROLLER_BOARDS] == [True, True, False]
    assumed = Assumptions(quality="known pedigree")
    found = import_bom(saved, tmp_path / "pedigree.yaml", assumptions=assumed, environment="indoor")
    assert min(CONTROLLER_BOARDS) < 1 / total_rate(found.parts) < max(CONTROLLER_BOARDS)
