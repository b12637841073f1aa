"""The fault tree of a robot: each part's probability by its closed form, and the same figure as of the robot."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.health.fault_tree import constant_rates, fault_tree
from robophm.health.outlooks import as_designed, nominal_outlook
from robophm.health.plant import Plant

DESIGN = """
schema_version: 1
name: Rover
usage: {operating: 0.5, kilometres: 2 km/h}
functions:
  drive: {series: [computer, wheel]}
components:
  computer: {rate: 10 FPMH}
  wheel: {rate: 20 FPMH, quantity: 2}
  tyre: {rate: 1e-4 /km, clock: kilometres}
  frame: {rate: 3 FPMH, clock: calendar}
  lamp: {rate: 5 FPMH, life: {distribution: weibull, shape: 2}, quantity: 2, required: 1}
  board: {rate: unknown}
"""
ROBOT = parse(DESIGN)
NEW = as_designed(Plant(ROBOT))


def failed(hours: float, calendar: float | None = None) -> dict[str, float]:
    """By hand, after so many hours of operation and of the calendar: two of these to one of operation."""
    calendar = 2 * hours if calendar is None else calendar
    lamp = -math.expm1(-((math.gamma(1.5) * 5e-6 * hours) ** 2))  # Weibull of mean 200,000 h
    return {
        "computer": -math.expm1(-1e-5 * hours), "wheel": -math.expm1(-4e-5 * hours),
        "tyre": -math.expm1(-2e-4 * hours), "frame": -math.expm1(-3e-6 * calendar),
        "lamp[1]": lamp, "lamp[2]": lamp, "board": 0.0,
    }  # fmt: skip


@pytest.mark.parametrize("hours", [0.0, 1.0, 5000.0])
def test_each_part_as_its_life_says(hours: float) -> None:
    found = fault_tree(NEW, None, hours)
    assert dict(zip(found.tree.names, found.occurred, strict=True)) == pytest.approx(failed(hours), rel=1e-12)
    assert found.not_yet == pytest.approx(1 - found.occurred, rel=1e-12)
    assert found.unknown is not None
    assert found.unknown.parts == 1


def test_of_a_function_only_what_it_needs() -> None:
    found, each = fault_tree(NEW, "drive", 2000.0), failed(2000.0)
    assert set(found.tree.names) == {"computer", "wheel"}
    assert found.probability == pytest.approx(1 - (1 - each["computer"]) * (1 - each["wheel"]), rel=1e-13)
    assert found.unknown is None


def test_now_is_what_has_been_lived_and_ahead_is_added_to_it() -> None:
    plant = Plant(ROBOT)
    aged = nominal_outlook(plant, np.array([1000.0 * (2 if mode.clock == "kilometres" else 1) for mode in ROBOT.modes]))
    now, later = fault_tree(aged), fault_tree(aged, hours=500.0)
    assert dict(zip(now.tree.names, now.occurred, strict=True)) == pytest.approx(failed(1000.0, 1000.0), rel=1e-12)
    assert dict(zip(later.tree.names, later.occurred, strict=True)) == pytest.approx(failed(1500.0, 2000.0), rel=1e-12)
    for tree, hours in ((now, 0.0), (later, 500.0)):
        state = aged.survival_curve(ROBOT.diagram, np.array([hours]))
        assert tree.probability == pytest.approx(float(state.failed[0]), rel=1e-12)


def test_a_group_of_dependent_parts_is_one_event() -> None:
    """A cold standby pair of equal rates: Erlang."""
    robot = parse(
        "schema_version: 1\nname: R\ncomponents: {A: {rate: 0.01 /h}, B: {rate: 0.01 /h}}\n"
        "diagram: {standby: {of: [A, B]}}\n"
    )
    found = fault_tree(as_designed(Plant(robot)), hours=50.0)
    assert len(found.tree.names) == 1
    assert found.occurred == pytest.approx(1 - 1.5 * math.exp(-0.5), rel=1e-9)


def test_constant_rates_are_per_hour_of_operation() -> None:
    """A tyre rolls at 2 km/h; what ages by the calendar, wears or is of unknown rate has none."""
    expected = {"computer": 1e-5, "wheel": 4e-5, "tyre": 2e-4}
    assert constant_rates(ROBOT) == pytest.approx(expected, rel=1e-14)


def test_what_cannot_be_asked_is_refused() -> None:
    with pytest.raises(RobophmError, match="no function 'drve'; did you mean 'drive'"):
        fault_tree(NEW, "drve")
    with pytest.raises(RobophmError, match="nan h: expected a finite number"):
        fault_tree(NEW, hours=math.nan)
