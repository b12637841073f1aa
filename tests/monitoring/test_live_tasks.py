"""The tasks of a robot that runs: what is remembered for them stays small, however long it runs."""

from __future__ import annotations

import pickle

import pytest

from robophm.core.signal import SECOND, Sample
from robophm.monitoring.live_tasks import LiveTasks
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_watch import WearWatch

from .designs import robot

PARTS, HOURS = 300, 26
NUMBERS = 12
"""Numbers that a failure mode may take in each remembered past: its sums, and what is open of its history."""


@pytest.mark.full
def test_what_is_remembered_for_tasks_is_sums_and_not_the_steps_they_are_of():
    """After more than a day, when as much is forgotten as is remembered."""
    hot = {"acceleration": {"model": "q10"}, "signals": {"temperature": {"topic": "/hot", "field": "temperature"}}}
    design = robot(components={f"part {k}": {"rate": "0.01 /h", **(hot if k == 0 else {})} for k in range(PARTS)})
    monitor = Monitor(design)
    tasks = LiveTasks(monitor, WearWatch(design))
    monitor.on_tick = lambda _: tasks.remember()
    for minute in range(60 * HOURS):
        monitor.observe(Sample((1_800_000_000 + 60 * minute) * SECOND, *design.signals, 20.0 + minute % 7))
    assert len(tasks._past) > 200
    assert len(pickle.dumps(tasks._past)) < len(tasks._past) * 8 * NUMBERS * PARTS
