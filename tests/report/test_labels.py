"""What stands in a box of a diagram."""

import pytest

from robophm.design.file import parse
from robophm.report.labels import part_labels


@pytest.mark.parametrize(
    ("said", "badge"),
    [
        ("", ""),
        ("quantity: 4", "×4"),
        ("quantity: 4, required: 4", "×4"),
        ("quantity: 4, required: 3", "3 of 4"),
        ("quantity: 2, required: 1", "1 of 2"),
    ],
)
def test_equal_parts_that_can_stand_in_for_each_other_are_told_from_those_that_cannot(said, badge):
    robot = parse(f"schema_version: 1\nname: R\ncomponents: {{A: {{rate: 1 FIT, {said}}}}}")
    assert part_labels(robot, {"A": 4e-9})("A").badge == badge


def test_a_member_has_its_share_of_the_rate_and_no_badge():
    robot = parse("schema_version: 1\nname: R\ncomponents: {A: {rate: 1 FIT, quantity: 4, required: 3}}")
    label = part_labels(robot, {"A": 4e-9}, stale=["A[2]"])("A[2]")
    assert (label.title, label.detail, label.badge, label.tone) == ("A[2]", "1e-9 /h", "", "stale")
