"""A part replaced or repaired: its life begins anew or in part, and what was before stays known."""

import json

import numpy as np
import pytest

from robophm.core.errors import RobophmError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import outlooks
from robophm.health.plant import Plant
from robophm.health.service import repair, replace, service_intervals, services_of
from robophm.monitoring.monitor import Monitor

DESIGN = """
schema_version: 1
name: R
powered: {topic: /on, field: data}
signals: {temperature: {topic: /t, field: t, unit: degC, range: [-40, 150], max_age: 100000 s}}
acceleration: {model: q10}
components:
  bearing: {rate: 200 FPMH, life: {distribution: weibull, shape: 3}, initial_exposure: 500 h}
  gear: {rate: 100 FPMH, life: {distribution: weibull, shape: 2}, scaling: hazard, initial_exposure: 100 h}
  motor: {quantity: 2, required: 1, rate: 90 FPMH}
  arm: {failure_modes: {a: {rate: 1 FPMH}, b: {rate: 2 FPMH}}}
"""
START = 1_700_000_000 * SECOND


@pytest.fixture
def robot():
    return parse(DESIGN)


@pytest.fixture
def worked(robot):
    """A robot that has worked for 1000 h at 45 °C: four times as fast."""
    monitor = Monitor(robot, period=HOUR / SECOND)
    for hour in range(0, 1001, 20):
        for signal, value in (("/on.data", 1.0), ("/t.t", 45.0), (CLOCK, 0.0)):
            monitor.observe(Sample(START + hour * HOUR, signal, value))
    return ExposureIntegrator(robot).settled(monitor.ledger)


def lived(robot, ledger):
    return outlooks(Plant(robot), ExposureIntegrator(robot), ledger, future="nominal")["sensor_based"]


def test_a_replaced_part_is_a_new_part(robot, worked):
    unused = parse(DESIGN.replace(", initial_exposure: 500 h", "").replace(", initial_exposure: 100 h", ""))
    new = outlooks(Plant(unused), ExposureIntegrator(unused), Ledger.new(unused))
    diagrams = {"bearing": 0, "gear": 1}
    for path, i in diagrams.items():
        replace(robot, worked, path, failed=True)
        for view, one in outlooks(Plant(robot), ExposureIntegrator(robot), worked, future="nominal").items():
            part, fresh = one.plant.alone[i], new[view].plant.alone[i]
            assert one.remaining_life(part) == new[view].remaining_life(fresh)
            assert float(one.survival(part).works) == 1.0
    other = lived(robot, worked)
    assert float(other.survival(other.plant.alone[2]).works) < 1.0  # what was not replaced


@pytest.mark.parametrize("remaining", [0.0, 0.3, 1.0])
def test_a_repair_leaves_a_share_of_the_effective_age(robot, worked, remaining):
    before = lived(robot, worked)
    repair(robot, worked, "bearing", remaining, failed=True)
    after = lived(robot, worked)
    assert before.age[0] == pytest.approx(500 + 4 * 1000, rel=2e-3)
    assert after.age[0] == pytest.approx(remaining * before.age[0], rel=1e-12)
    assert after.cumulative_hazard[0] == pytest.approx(remaining**3 * before.cumulative_hazard[0], rel=1e-10)
    assert after.unseen_hazard[0] == 0.0  # it was seen to work when it was repaired
    np.testing.assert_array_equal(after.cumulative_hazard[1:], before.cumulative_hazard[1:])


@pytest.mark.parametrize("remaining", [0.0, 0.3, 1.0])
def test_hazard_that_is_a_sum_shrinks_as_its_life_does(robot, worked, remaining):
    before = lived(robot, worked)
    repair(robot, worked, "gear", remaining, failed=False)
    after = lived(robot, worked)
    assert after.age[1] == pytest.approx(remaining * before.age[1], rel=1e-12)
    assert after.cumulative_hazard[1] == pytest.approx(remaining**2 * before.cumulative_hazard[1], rel=1e-10)


def test_history_is_kept_and_comes_back(robot, worked):
    lives = {one.mode.path: one for one in service_intervals(robot, worked)}
    replace(robot, worked, "bearing", failed=True)
    repair(robot, worked, "gear", 0.5, failed=True)
    kept = Ledger.of(robot, json.loads(json.dumps(worked.to_json(), allow_nan=False)))
    assert kept.services == worked.services
    found = [one for one in service_intervals(robot, kept) if one.mode.path in ("bearing", "gear")]
    assert [(one.mode.path, one.failed) for one in found] == [
        ("bearing", True), ("bearing", False), ("gear", True), ("gear", False)
    ]  # fmt: skip
    assert found[0].hazard == lives["bearing"].hazard > 0
    assert (found[1].hazard, found[1].hours, found[3].hazard) == (0.0, 0.0, 0.0)
    assert found[2].hazard == pytest.approx(lives["gear"].hazard)
    assert [one.parts for one in service_intervals(robot, kept) if one.mode.path == "motor"] == [2]
    assert [services_of(robot, kept, part) for part in ("bearing", "gear", "arm")] == [
        kept.services[:1], kept.services[1:], []
    ]  # fmt: skip
    with pytest.raises(RobophmError, match="no part 'ger'; did you mean 'gear'"):
        services_of(robot, kept, "ger")


def test_a_ledger_of_before_has_no_services(robot, worked):
    data = worked.to_json()
    del data["services"]
    assert Ledger.of(robot, data).services == []


def test_refusals(robot, worked):
    before = worked.to_json()
    for path, said in (("bearng", "did you mean 'bearing'"), ("motor[1]", "one age for the 2 equal parts of 'motor'"),
                       ("motor[2]/any", "one age for the 2 equal parts of 'motor'"), ("gear/any", "no part 'gear/any'"),
                       ("arm", "expected one of 'arm/a', 'arm/b'")):  # fmt: skip
        with pytest.raises(RobophmError, match=said):
            replace(robot, worked, path, failed=True)
    for share in (-0.1, 1.1, float("nan")):
        with pytest.raises(RobophmError, match="expected 0"):
            repair(robot, worked, "bearing", share, failed=False)
    assert worked.to_json() == before
    replace(robot, worked, "arm/a", failed=True)
    assert [(one.mode.split(" ")[0], one.failed) for one in worked.services] == [("arm/a", True), ("arm/b", False)]
