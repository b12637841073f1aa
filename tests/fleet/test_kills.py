"""Robots, network and service killed at random: nothing lost, nothing twice, ledgers equal letter by letter."""

from __future__ import annotations

import pytest
from tests.fleet.killed import course


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_nothing_is_lost_or_counted_twice(tmp_path, seed):
    found = course(tmp_path, seed, robots=2, most=60, kills=3)
    assert found["reports"] == 120
    assert found["epochs"] > 2  # some were killed while they worked
