"""When a change began and ended, beside a plain loop, and where its signal was moved."""

import numpy as np
import pytest

from robophm.learning.wear.alarm_episodes import episodes
from robophm.learning.wear.cusum import Cusum, design

DETECTOR = Cusum(0.0, 1.0, 0.5, 4.0, 1000.0, 10.0, 1.0, 3, drifts=False)


def test_by_hand():
    """Sums up: 0, 0, 1.5, 3, 4.5 → held at 4, 2.5, 1, 0, so that it was over behind the 4; down it is the same."""
    up = [9.0, 9.0, 9.0, 0.0, 0.0, 2.0, 2.0, 2.0, -1.0, -1.0, -1.0, 0.0]
    (one,) = episodes(DETECTOR, up)
    assert (one.begin, one.raised, one.end) == (5, 7, 8)
    assert one.level == pytest.approx(2.0)
    (down,) = episodes(DETECTOR, [-value for value in up])
    assert down[:3] == one[:3]
    (lasting,) = episodes(DETECTOR, up[:8])
    assert lasting.end is None


def test_a_stretch_that_was_moved_is_found_with_its_ends_and_level():
    rng = np.random.default_rng(4)
    values = 5 + 0.1 * rng.standard_normal(600)
    values[300:400] += 0.3
    detector = design(values[:100], 1000.0)
    longest = max(episodes(detector, values), key=lambda one: (one.end or 600) - one.begin)
    assert abs(longest.begin - 300) <= 15
    assert longest.begin <= longest.raised < 310
    assert 396 <= longest.end < 408
    assert longest.level == pytest.approx(5.3, abs=0.05)
    first = detector.alarms(values[100:])[1][0] + 100
    assert next(iter(episodes(detector, values))).raised == first
