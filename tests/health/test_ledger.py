"""The ledger adds up: however a run is cut, stopped, looked at or put together; and it fits its own parts alone."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robophm.core.errors import StoreError
from robophm.core.signal import SECOND
from robophm.health.ledger import Ledger, Total
from robophm.monitoring.monitor import Monitor

from .exposures import LEDGER, SAMPLES, SCHEDULES, SHOP, kept, monitor, settled


@given(st.lists(st.integers(0, len(SAMPLES)), max_size=4))
def test_restarts_change_no_bit(cuts: list[int]) -> None:
    ledger = Ledger.new(SHOP)
    for begin, end in pairwise([0, *sorted(cuts), len(SAMPLES)]):
        ledger = monitor(SHOP, SAMPLES[begin:end], ledger=kept(ledger)).ledger
    assert ledger.to_json() == LEDGER


@pytest.mark.parametrize("period", [0.5, 7.0, 3600.0])
def test_the_period_does_not_matter(period: float) -> None:
    one, other = settled(SHOP, SAMPLES), settled(SHOP, SAMPLES, period)
    for name in ("age", "effective", "hazard", "clocks"):
        assert getattr(other, name).value == pytest.approx(getattr(one, name).value, rel=1e-12, abs=0)
    assert (other.last, other.stale, other.counts) == (one.last, one.stale, one.counts)


@given(st.randoms(use_true_random=False))
def test_two_recordings_merge_into_one_run(random: random.Random) -> None:
    """Each in its own order, one up to half a second behind the other."""
    lag = {signal: random.randrange(SECOND // 2) for signal in SCHEDULES}
    merged = sorted(SAMPLES, key=lambda sample: sample.time + lag[sample.signal])
    one, other = settled(SHOP, SAMPLES), settled(SHOP, merged)
    for name in ("age", "effective", "hazard", "clocks"):
        assert getattr(other, name).value == pytest.approx(getattr(one, name).value, rel=1e-12, abs=0)
    assert other.counts == one.counts == {}


def test_looking_changes_nothing() -> None:
    observer = Monitor(SHOP)
    for i, sample in enumerate(SAMPLES):
        observer.observe(sample)
        if i % 100 == 0:
            before = observer.ledger.to_json()
            observer.exposure.settled(observer.ledger)
            observer.report(remaining_life=False)
            assert observer.ledger.to_json() == before
    assert observer.ledger.to_json() == LEDGER


@pytest.mark.full
def test_a_million_small_additions_lose_nothing() -> None:
    # a second at a time after a year, and what a plain sum loses entirely
    total, plain = Total(np.array([8760.0, 1.0]), np.zeros(2)), np.array([8760.0, 1.0])
    small = np.array([1 / 3600, 1e-17])
    for _ in range(10**6):
        total.add(small)
        plain += small
    expected = [Fraction(first) + 10**6 * Fraction(each) for first, each in zip((8760, 1), small.tolist(), strict=True)]
    assert total.value == pytest.approx([float(one) for one in expected], rel=2e-16, abs=0)
    assert plain[1] == 1.0  # so that this test can fail


def test_a_ledger_of_a_part_that_may_have_another_name_is_refused() -> None:
    data = Ledger.new(SHOP).to_json()
    renamed = tuple(mode.replace("plain ", "simple ") for mode in data["modes"])
    with pytest.raises(StoreError, match=r"'plain \(operating, age scaling\)' is in it or in the design alone"):
        Ledger.from_json(data, renamed, ())
    with pytest.raises(StoreError, match="version 0; expected 2"):
        Ledger.from_json({**data, "version": 0}, tuple(data["modes"]), ())


def test_a_ledger_follows_its_parts_when_the_design_puts_them_in_another_order() -> None:
    turned = tuple(reversed(LEDGER["modes"]))
    moved = Ledger.from_json(LEDGER, turned, ())
    assert moved.effective.value.tolist() == monitor(SHOP, SAMPLES).ledger.effective.value[::-1].tolist()
    assert moved.recent[0].age.tolist() == monitor(SHOP, SAMPLES).ledger.recent[0].age[::-1].tolist()
