"""Whatever is wrong in a design, what can be drawn is drawn, and the mistake is said at the block that it is of."""

from __future__ import annotations

import pytest

from robophm.blocks.diagram import units
from robophm.design.drawable import MOST_ROUNDS, Drawable, drawable
from robophm.design.problems import check

DESIGN = """\
schema_version: 1
name: R
thresholds: {reliability: 0.9}
modules:
  drive:
    diagram: {parallel: [left, right]}
    signals: {temperature: {topic: /t, field: c}}
    components:
      left: {rate: 1 FPMH, quantity: 1}
      right: {rate: 2 FPMH, clock: operating}
components:
  lamp: {rate: 3 FPMH, depends_on: drive}
"""
PARTS = ["drive/left", "drive/right", "lamp"]


def drawn(*changes: tuple[str, str]) -> Drawable:
    """The design with some texts in place of others, which leave it no design."""
    text = DESIGN
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    checked = check(text)
    assert checked.robot is None
    found = drawable(checked.document, checked.lines)
    assert found is not None
    assert found.problems[0] == checked.problems[0]  # as the engine says it
    return found


def parts(found: Drawable) -> list[str]:
    return [part.path for part in found.robot.all_components()]


@pytest.mark.parametrize(
    ("changes", "unknown"),
    [
        ([("1 FPMH", "1 FPMHH")], {"drive/left"}),
        ([("1 FPMH", "1 FPMHH"), ("clock: operating", "clock: never")], {"drive/left", "drive/right"}),
        ([("quantity: 1", "quantity: none")], {"drive/left"}),
        ([("quantity: 1", "quantity: none, wings: 2")], {"drive/left"}),
        ([("clock: operating", "clock: cycles")], {"drive/right"}),  # whose rate is not of that clock
    ],
)
def test_what_is_wrong_is_drawn_without_its_rate(changes: list[tuple[str, str]], unknown: set[str]) -> None:
    found = drawn(*changes)
    good = check(DESIGN).robot
    assert good is not None
    assert set(units(found.robot.diagram)) == set(units(good.diagram))
    assert {part.path for part in found.robot.all_components() if part.unknown} == unknown
    assert {path for path, said in found.wrong.items() if said} == unknown
    rates = {mode.path: mode.rate for mode in good.modes}
    assert all(mode.unknown or mode.rate == rates[mode.path] for mode in found.robot.modes)
    assert not found.unwired


def test_a_wrong_sensor_or_threshold_is_left_out() -> None:
    for old, new in (("field: c", "felt: c"), ("reliability: 0.9", "reliability: 9"), ("name: R", "name: R\nwings: 2")):
        assert not any(part.unknown for part in drawn((old, new)).robot.all_components())


@pytest.mark.parametrize(
    ("old", "new", "unknown"),
    [
        ("name: R", "name:", set()),
        ("name: R", "name: 5", set()),
        ("{rate: 1 FPMH, quantity: 1}", "", {"drive/left"}),
    ],
)
def test_what_is_half_typed_is_drawn(old: str, new: str, unknown: set[str]) -> None:
    found = drawn((old, new))
    assert [*units(found.robot.diagram)] == [*PARTS, *PARTS[:2]]  # the lamp, and what it depends on
    assert {part.path for part in found.robot.all_components() if part.unknown} == unknown


def test_an_unknown_name_in_a_diagram_is_a_block_that_says_so() -> None:
    found = drawn(("[left, right]", "[left, wheel, right]"))
    assert [*units(found.robot.levels["drive"].wiring)] == ["drive/left", "drive/wheel", "drive/right"]
    assert found.mistakes("drive/wheel") == [found.problems[0].message]
    assert found.mistakes("drive") == found.mistakes("drive/wheel")
    assert not found.mistakes("lamp")
    assert not found.unwired


@pytest.mark.parametrize(
    "diagram",
    [
        "{paralel: [left, right]}",
        "{parallel: [left, 5]}",
        "{parallel: []}",
        "{k_of_n: {k: 3, of: [left, right]}}",
        "{network: {from: left, to: right, links: [[left, x]]}}",
        "{standby: {of: [left, rigth]}}",
        "{standby: {of: [left, left]}}",
        "{series: [left, /drive]}",
        "none",
    ],
)
def test_a_wrong_diagram_leaves_the_parts_and_does_not_say_how_they_are_wired(diagram: str) -> None:
    found = drawn(("{parallel: [left, right]}", diagram))
    assert set(PARTS) <= {*parts(found)}
    assert found.mistakes("drive") == [found.problems[0].message]
    assert found.unwired == (set() if diagram == "none" else {"drive"})


@pytest.mark.parametrize("needs", ["driver", "{seres: [drive]}", "[drive, 5]", "lamp"])
def test_a_wrong_dependence_is_said_at_what_depends(needs: str) -> None:
    found = drawn(("depends_on: drive", f"depends_on: {needs}"))
    assert parts(found) == PARTS
    assert found.mistakes("lamp") == [found.problems[0].message]
    assert not found.unwired
    assert not any(part.unknown for part in found.robot.all_components())


@pytest.mark.parametrize("empty", ["{}", "", "5", "{components: {}}", "{description: to come}"])
def test_an_empty_module_is_a_block_that_says_so(empty: str) -> None:
    found = drawn(("components:\n  lamp", f"  arm: {empty}\ncomponents:\n  lamp"))
    assert [*units(found.robot.wiring)] == ["drive", "arm", "lamp"]
    assert found.empty == {"arm"}
    assert found.mistakes("arm") == [found.problems[0].message]


def test_a_wrong_rate_in_a_group_that_needs_it_leaves_the_group() -> None:
    found = drawn(("{parallel: [left, right]}", "{standby: {of: [left, right]}}"), ("1 FPMH", "1 FPMHH"))
    assert found.wrong == {"drive/left": [found.problems[0].message]}
    assert not found.unwired


@pytest.mark.parametrize(
    ("old", "new", "left"),
    [
        ("  lamp:", "  drive:", PARTS[:2]),  # two of one name: the module stays
        ("      left:", "      le/ft:", PARTS),  # which the diagram draws all the same
        ("  drive:", "  dri/ve:", ["lamp"]),
        ("modules:", "modules: 5\nmodule:", ["lamp"]),
    ],
)
def test_what_cannot_be_named_is_said_at_its_level(old: str, new: str, left: list[str]) -> None:
    found = drawn((old, new))
    assert sorted(parts(found)) == left
    assert found.mistakes("")


def test_many_mistakes_that_are_found_one_by_one_leave_the_names_of_all_parts() -> None:
    names = [f"part {i}" for i in range(3 * MOST_ROUNDS)]
    text = "schema_version: 1\nname: R\ncomponents:\n"
    text += "".join(f"  {name}: {{rate: 1 FPMH, depends_on: nobody}}\n" for name in names)
    checked = check(text)
    found = drawable(checked.document, checked.lines)
    assert found is not None
    assert parts(found) == names
    assert found.unwired == {""}
    assert len(found.problems) > MOST_ROUNDS


def test_what_is_no_design_at_all_is_not_drawn() -> None:
    for text in ("a: [", "", "- 5"):
        checked = check(text)
        assert drawable(checked.document, checked.lines) is None
