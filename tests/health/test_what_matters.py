"""What matters and what to replace first, asked together: each as it is alone, within the same hours."""

from __future__ import annotations

import math

import pytest

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.design.task import Task
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.what_matters import what_matters

ROBOT = parse("""
schema_version: 1
name: R
usage: {operating: 0.5}
components:
  worn: {rate: 1e-3 /h, life: {distribution: weibull, shape: 3}, initial_exposure: 900 h}
  young: {rate: 1e-3 /h, life: {distribution: weibull, shape: 0.5}, initial_exposure: 500 h}
  plain: {rate: 1e-3 /h}
""")
NEW = as_designed(Plant(ROBOT))
VIEWS = {"nominal": NEW, "sensor_based": NEW}


def test_within_half_a_life_that_is_shorter_than_usual() -> None:
    found = what_matters(VIEWS, ROBOT.diagram)
    median = NEW.remaining_life(ROBOT.diagram).median
    assert found.importances.keys() == found.replacements.keys() == VIEWS.keys()
    for one in found.importances.values():
        assert one.hours == pytest.approx(0.5 * median, rel=1e-9)  # half of its life, of operation
        assert not one.has_failed
        assert one.lifelong
    for gains in found.replacements.values():
        assert gains.median == pytest.approx(median, rel=1e-9)
        assert gains.completion_failure is None


def test_within_the_hours_that_are_asked_for() -> None:
    found = what_matters({"sensor_based": NEW}, ROBOT.diagram, Task.plain(0.0, 20.0), 10.0)
    (one,), (gains,) = found.importances.values(), found.replacements.values()
    assert one.hours == 10.0
    scale = 1000 / math.gamma(4 / 3)
    worn = (910 / scale) ** 3 - (900 / scale) ** 3
    young = math.sqrt(510 / (1000 / 2)) - math.sqrt(500 / (1000 / 2))
    assert one.failure == pytest.approx(-math.expm1(-worn - young - 1e-3 * 10), rel=1e-9)
    # A new one of what wears gains, of what has outlived its early failures loses, of what does not age neither.
    changing = {part.path: part for part in gains.changing}
    assert changing.keys() == {"worn", "young"}
    assert (changing["worn"].completion or 0) > 0 > (changing["young"].completion or 0)
    assert gains.losing == 1


@pytest.mark.parametrize("hours", [0.0, -1.0, math.nan, 2e9])
def test_hours_that_are_none_are_refused(hours: float) -> None:
    with pytest.raises(RobophmError, match=r"hours .*: expected a number above 0 and at most 1e\+09"):
        what_matters({"sensor_based": NEW}, ROBOT.diagram, hours=hours)
