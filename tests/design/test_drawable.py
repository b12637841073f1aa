"""One wrong value does not take the diagram away; a wrong diagram does, for what it would show is not known."""

from __future__ import annotations

import pytest

from robophm.blocks.diagram import units
from robophm.design.drawable import drawable
from robophm.design.problems import check

DESIGN = """\
schema_version: 1
name: R
thresholds: {{reliability: 0.9}}
modules:
  drive:
    diagram: {{parallel: [left, right]}}
    signals: {{temperature: {{topic: /t, field: c}}}}
    components:
      left: {{rate: {left}, quantity: {quantity}}}
      right: {{rate: 2 FPMH, clock: {clock}}}
components:
  lamp: {{rate: 3 FPMH}}
"""
GOOD = {"left": "1 FPMH", "quantity": "1", "clock": "operating"}


@pytest.mark.parametrize(
    ("wrong", "unknown"),
    [
        ({"left": "1 FPMHH"}, {"drive/left"}),
        ({"left": "1 FPMHH", "clock": "never"}, {"drive/left", "drive/right"}),
        ({"quantity": "none"}, {"drive/left"}),
        ({"clock": "cycles"}, {"drive/right"}),  # whose rate is not of that clock
    ],
)
def test_what_is_wrong_is_drawn_without_its_rate(wrong: dict[str, str], unknown: set[str]) -> None:
    text = DESIGN.format(**GOOD | wrong)
    robot = drawable(text)
    assert check(text).robot is None
    good = check(DESIGN.format(**GOOD)).robot
    assert robot is not None
    assert good is not None
    assert set(units(robot.diagram)) == set(units(good.diagram))
    assert {part.path for part in robot.all_components() if part.unknown} == unknown
    rates = {mode.path: mode.rate for mode in good.modes}
    assert all(mode.unknown or mode.rate == rates[mode.path] for mode in robot.modes)


def test_a_wrong_sensor_or_threshold_is_left_out() -> None:
    text = DESIGN.format(**GOOD)
    for old, new in (("field: c", "felt: c"), ("reliability: 0.9", "reliability: 9"), ("name: R", "name: R\nwings: 2")):
        robot = drawable(text.replace(old, new))
        assert robot is not None
        assert not any(part.unknown for part in robot.all_components())


@pytest.mark.parametrize(
    ("old", "new", "unknown"),
    [
        ("name: R", "name:", set()),
        ("name: R", "name: 5", set()),
        ("{{rate: {left}, quantity: {quantity}}}", "", {"drive/left"}),
    ],
)
def test_what_is_half_typed_is_drawn(old: str, new: str, unknown: set[str]) -> None:
    text = DESIGN.replace(old, new).format(**GOOD)
    robot = drawable(text)
    assert check(text).robot is None
    assert robot is not None
    assert [*units(robot.diagram)] == ["drive/left", "drive/right", "lamp"]
    assert {part.path for part in robot.all_components() if part.unknown} == unknown


def test_a_wrong_diagram_is_not_drawn_otherwise() -> None:
    text = DESIGN.format(**GOOD)
    assert drawable(text.replace("[left, right]", "[left, wheel]")) is None
    assert drawable("a: [") is None
    assert drawable("") is None
