"""A later draft changes only what nobody touched, and says of everything else why it stays."""

import pytest
from tests.drafting.robots import DATA

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.drafting.answers import Answers
from robophm.drafting.composing import change_of
from robophm.drafting.drafting import new
from robophm.drafting.updating import earlier_answers, updated

ARM = DATA / "six_axis_arm.urdf"


def draft(changes=(), **answers):
    return new(ARM, answers=Answers(**answers), changes=[change_of(one) for one in changes])


def states(found):
    return {one.name: one.state for one in found.outcomes}


def test_the_same_again_changes_no_letter():
    text = draft().text
    found = updated(text, draft(), "robot.yaml")
    assert found.text == text
    assert set(states(found).values()) == {"unchanged"}


def test_what_nobody_touched_follows_the_new_answers():
    first, second = draft(), draft(computer="jetson", hours="12")
    found = updated(first.text, second, "robot.yaml")
    assert states(found)["computing/computer"] == "changed"
    assert states(found)["usage"] == "changed"
    assert found.text == second.text  # letter for letter, as if it had been drafted so
    assert earlier_answers(found.text) == {"computer": "jetson", "hours": "12"}


def test_what_somebody_edited_is_theirs_with_every_remark():
    text = draft().text
    edited = text.replace("part: industrial_pc", "part: industrial_pc\n        mtbf: 90000 h  # from the maker")
    edited = edited.replace("usage: {operating: 0.333333", "usage: {operating: 0.25")
    edited = "# my robot\n" + edited.replace("modules:\n", "# what follows is mine\nmodules:\n", 1)
    found = updated(edited, draft(computer="jetson", hours="12"), "robot.yaml")
    assert states(found)["computing/computer"] == "kept"
    assert states(found)["usage"] == "kept"
    assert found.text.replace('# answers: {"hours": "12", "computer": "jetson"}', "# answers: {}") == edited
    assert parse(found.text).usage.operating == 0.25


def test_a_part_that_somebody_took_out_stays_out_and_one_that_is_new_comes_in():
    text = draft().text
    start = text.index("      force torque sensor:")
    end = text.index("  power:", start)
    without = text[:start].removesuffix("  sensing:\n    components:\n") + text[end:]
    found = updated(without, draft(["extra/fan=cooling fan", "power/fan=cooling fan"]), "robot.yaml")
    assert states(found)["sensing/force torque sensor"] == "kept"
    assert states(found)["extra/fan"] == states(found)["power/fan"] == "added"
    paths = {part.path for part in parse(found.text).all_components()}
    assert {"extra/fan", "power/fan"} <= paths
    assert "sensing/force torque sensor" not in paths


def test_a_part_that_the_draft_has_no_longer_goes_unless_a_diagram_names_it():
    text = draft(needs="sensing, computer").text
    found = updated(text, draft(["force torque sensor=none", "power supply=none"]), "robot.yaml")
    assert states(found)["power/power supply"] == "removed"
    assert states(found)["sensing/force torque sensor"] == "kept"  # its module is needed for a task
    paths = {part.path for part in parse(found.text).all_components()}
    assert "power/power supply" not in paths
    assert "sensing/force torque sensor" in paths


def test_a_head_that_was_spoilt_is_refused_with_its_line():
    text = draft().text.replace("# answers: {}", "# answers: {nonsense")
    with pytest.raises(DesignError, match=r"design:3: '# answers: ' is no JSON that a draft wrote"):
        earlier_answers(text)


def test_a_design_in_braces_is_refused_and_not_lost():
    with pytest.raises(DesignError, match="written in braces"):
        updated("{schema_version: 1, name: r, components: {a: {rate: 1 FIT}}}", draft(), "robot.yaml")


def test_a_design_that_was_never_drafted_gets_the_parts_beside_its_own():
    own = "schema_version: 1\nname: mine\nmodules:\n  power:\n    components:\n      cell:\n        rate: 5 FIT\n"
    found = updated(own, draft(), "robot.yaml")
    paths = {part.path for part in parse(found.text).all_components()}
    assert {"power/cell", "power/power supply", "elbow/gear"} <= paths


def test_a_parts_list_that_comes_later_is_taken_in_once(tmp_path):
    board = tmp_path / "board.csv"
    board.write_text("Reference,Value,Footprint,Qty\nR1,10k,R_0603_1608Metric,1\n")
    later = new(ARM, parts_lists={"elbow/board": board})
    found = updated(draft().text, later, "robot.yaml")
    assert states(found)["elbow/board"] == "changed"
    assert "elbow/board/R1" in {part.path for part in parse(found.text).all_components()}
    again = updated(found.text, later, "robot.yaml")
    assert again.text == found.text
    assert states(again)["elbow/board"] == "unchanged"
