"""Robots, network, service, database and broker killed at random: nothing lost or twice, ledgers equal by letter."""

from __future__ import annotations

import pytest
from tests.fleet.killed import KilledBroker, course
from tests.fleet.postgresql_server import missing, running
from tests.transports.mqtt.conftest import mosquitto

__all__ = ["mosquitto"]


def test_nothing_is_lost_or_counted_twice(tmp_path):
    found = []
    for seed in (1, 2, 3):
        (tmp_path / str(seed)).mkdir()
        found.append(course(tmp_path / str(seed), seed, robots=2, most=60, kills=3))
    assert [one["reports"] for one in found] == [120] * 3
    assert max(one["epochs"] for one in found) > 2  # some were killed while they worked


@pytest.mark.full
@pytest.mark.skipif(missing() is not None, reason=missing() or "")
def test_nothing_is_lost_or_counted_twice_where_the_database_is_killed_too(tmp_path):
    with running() as server:
        found = course(tmp_path, 1, robots=2, most=60, kills=3, database=server)
    assert found["reports"] == 120


@pytest.mark.parametrize("seed", [11, 12, *(pytest.param(seed, marks=pytest.mark.full) for seed in range(13, 23))])
def test_nothing_is_lost_or_counted_twice_over_a_broker_that_is_killed_too(mosquitto, tmp_path, seed):
    broker = KilledBroker(tmp_path)
    try:
        found = course(tmp_path, seed, robots=2, most=60, kills=3, broker=broker)
    finally:
        broker.stop()
    assert found["reports"] == 120
    assert found["epochs"] >= 2  # more where a kill met a robot at work, as it does in most of these
