"""Tasks as one, the pause between lists, and what is known besides."""

from __future__ import annotations

import pytest

from robophm.core.errors import DesignError
from robophm.design.build_task import with_knowledge
from robophm.design.file import parse
from robophm.design.task import Knowledge, Leg, Plan, Task

LEGS = (Leg(1.0, 100.0, functions=("drive",)), Leg(0.5), Leg(0.25, 3.0))
PLAN = Plan((Task(LEGS[:2], "there"), Task(()), Task(LEGS[2:])), every=8.0)
ROBOT = parse(
    "schema_version: 1\nname: R\ncomponents: {a: {rate: 1e-4 /h}, b: {rate: 1e-4 /h, quantity: 2, required: 1}}\n"
)


def test_tasks_joined_are_all_their_legs_in_order() -> None:
    assert PLAN.joined == Task.joined(PLAN.tasks) == Task(LEGS)
    assert (PLAN.joined.distance, PLAN.joined.duration) == (103.0, 1.75)
    assert Plan(()).joined == Task(())


@pytest.mark.parametrize(("every", "gap"), [(8.0, 6.25), (1.75, 0.0), (1.0, 0.0), (None, 0.0)])
def test_the_gap_is_what_a_list_leaves_of_its_time(every: float | None, gap: float) -> None:
    assert Plan(PLAN.tasks, every=every).gap == gap


def test_more_is_known_than_the_plan_says() -> None:
    plan = Plan(PLAN.tasks, Knowledge(failed=frozenset({"b[1]"})), every=8.0)
    more = with_knowledge(plan, ROBOT, working=["a", "b[2]"])
    assert more == Plan(plan.tasks, Knowledge(frozenset({"b[1]"}), frozenset({"a", "b[2]"})), 8.0)
    assert with_knowledge(plan, ROBOT) == plan


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"working": ["b[1]"]}, r"b\[1\] is said to have failed and to work"),
        ({"failed": ["c"]}, "unknown part 'c'"),
        ({"failed": ["b"]}, r"'b' is 2 parts; expected b\[1\] … \[2\]"),
    ],
)
def test_what_cannot_be_known_is_refused(words: dict[str, list[str]], says: str) -> None:
    plan = Plan(PLAN.tasks, Knowledge(failed=frozenset({"b[1]"})))
    with pytest.raises(DesignError, match=says):
        with_knowledge(plan, ROBOT, **words)
