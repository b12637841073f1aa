"""How far a signal went and how large it was, as plain loops over its samples have it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robophm.core.signal import SECOND
from robophm.measured.held_values import HeldValues
from robophm.measured.travel import Travel

from .plain import stretches

SAMPLES = st.lists(st.tuples(st.integers(1, 20), st.floats(-100, 100)), min_size=2, max_size=20)
MAX_AGE = 10 * SECOND


def held(found):
    times, ends, values = (np.array([one[at] for one in found]) for at in (0, 1, 2))
    following = [(one[0], one[2]) for one in [*found[1:], found[-1]]]
    return HeldValues(times, values, ends, *(np.array([one[at] for one in following]) for at in (0, 1)))


@given(SAMPLES, st.integers(0, 20))
def test_it_is_the_sum_over_steps_without_gaps(steps, cut):
    times = np.cumsum([step for step, _ in steps]) * SECOND
    found = stretches(list(zip(times.tolist(), [value for _, value in steps], strict=True)), MAX_AGE)
    path = sum(abs(after[1] - value) for _, _, value, after in found if after)
    followed = sum(end - begin for begin, end, _, after in found if after) / SECOND
    known = sum(end - begin for begin, end, _, _ in found) / SECOND
    large = sum(abs(value) * (end - begin) for begin, end, value, _ in found) / SECOND
    whole = held(found)
    travel, other = Travel(), Travel()
    travel.add(HeldValues(*(one[:cut] for one in whole)))
    other.add(HeldValues(*(one[cut:] for one in whole)))
    travel += other
    assert travel.magnitude == pytest.approx(large / known, abs=1e-9)
    assert travel.pace == pytest.approx(path / followed, abs=1e-9) if followed else math.isnan(travel.pace)


def test_of_nothing_nothing_is_known():
    assert math.isnan(Travel().pace)
    assert math.isnan(Travel().magnitude)
