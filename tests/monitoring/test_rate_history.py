"""What a ledger tells of rates: lives, failures and hazards counted by hand."""

import math

import pytest

from robophm.core.errors import DataError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.health.service import replace
from robophm.learning.rates.failure_log import Seen, merged
from robophm.learning.rates.rate_update import learn
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.rate_history import rate_history

START = 1_700_000_000 * SECOND
ROBOT = """
schema_version: 1
name: R
powered: {topic: /on, field: data}
signals: {temperature: {topic: /t, field: c, unit: degC, max_age: 2 h, range: [-40, 200]}}
components:
  motor: {quantity: 2, rate: 0.01 /h}
  seal: {life: {distribution: gamma, shape: 3, scale: 20 h}%s}
"""


def lived(robot):
    """Ten hours, the seal replaced after it failed, five more."""
    monitor = Monitor(robot)
    for hour in range(16):
        for signal, value in (("/on.data", 1.0), ("/t.c", 25.0), (CLOCK, 0.0)):
            monitor.observe(Sample(START + hour * HOUR, signal, value))
        if hour == 10:
            monitor.ledger = monitor.exposure.settled(monitor.ledger)
            replace(robot, monitor.ledger, "seal", failed=True)
    return monitor.exposure.settled(monitor.ledger)


@pytest.fixture
def robot():
    return parse(ROBOT % "")


def test_every_life_of_every_part(robot):
    motor, seal = rate_history(robot, lived(robot), "r1")
    assert (motor.robot, motor.failures) == ("r1", 0)
    assert motor.exposure == pytest.approx(2 * 15)
    assert motor.expected == pytest.approx(2 * 15 * 0.01)
    assert (seal.failures, seal.exposure) == (1, pytest.approx(15))
    assert [one.length for one in seal.lives] == pytest.approx([10, 5])
    assert [(one.start, one.failures, one.parts) for one in seal.lives] == [(0, 1, 1), (0, 0, 1)]

    def erlang(hours):  # −ln of the survival of a gamma life of shape 3
        x = hours / 20
        return x - math.log(1 + x + x * x / 2)

    assert seal.expected == pytest.approx(erlang(10) + erlang(5))


def test_what_was_seen_in_one_robot_adds_up(robot):
    """One log after the other is as one log of all."""
    motor = robot.modes[0]
    parts = [Seen(motor, "r1", 1.0, 0.3, 30.0), Seen(motor, "r2", 0.0, 0.1, 10.0), Seen(motor, "r1", 2.0, 0.6, 60.0)]
    one, other = merged(parts)
    assert (one.robot, one.failures, one.expected, one.exposure) == ("r1", 3.0, pytest.approx(0.9), 90.0)
    assert other.robot == "r2"
    (found,) = learn(robot, parts[::2], "2 failures")
    assert (found.failures, found.expected) == (3.0, pytest.approx(0.9))
    (at_once,) = learn(robot, [Seen(motor, "r1", 3.0, 0.9, 90.0)], "2 failures")
    assert found.rate == pytest.approx(at_once.rate)
    assert found.robots == ("r1",)


def test_a_sum_of_scaled_hazard_says_nothing_of_other_rates():
    more = ", scaling: hazard, acceleration: {model: q10, reference_temperature: 25 degC}"
    robot = parse(ROBOT % more)
    with pytest.raises(DataError, match="'seal': of a gamma life with scaling: hazard a ledger keeps a sum"):
        rate_history(robot, lived(robot), "r1")
