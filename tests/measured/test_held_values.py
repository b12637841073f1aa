"""Samples come in order of their own time, and what comes too late for that is counted."""

from collections import Counter

import numpy as np

from robophm.core.signal import SECOND
from robophm.measured.held_values import SampleSorter
from robophm.measured.recordings import Recorded, Signal
from robophm.transports.recordings.columns import TopicColumns

T = Signal("/t.temperature", "/t", "temperature", "degC")
RECORDED = Recorded("x", (), {"/t": ("sensor_msgs/msg/Temperature", ("header.stamp.sec", "temperature"))})


def block(*rows):
    received, stamps, values = (np.array(column) for column in zip(*rows, strict=True))
    return {"/t": TopicColumns(received * SECOND, stamps * SECOND, {"temperature": values * 1.0}, {})}


def test_what_may_still_be_preceded_waits():
    ordered = SampleSorter(RECORDED, [T], Counter())
    first = ordered.feed(block((100, 100, 1), (101, 95, 2), (112, 112, 3)))
    assert (first[T.name].times // SECOND).tolist() == [95, 100]
    second = ordered.feed(block((113, 103, 4), (130, 130, 5)))
    assert (second[T.name].times // SECOND).tolist() == [103, 112]
    assert second[T.name].values.tolist() == [4, 3]
    assert (ordered.rest()[T.name].times // SECOND).tolist() == [130]


def test_what_comes_too_late_is_counted():
    notes = Counter()
    ordered = SampleSorter(RECORDED, [T], notes)
    ordered.feed(block((100, 100, 1), (200, 200, 2)))
    late = ordered.feed(block((150, 150, 3), (201, 201, 4)))
    assert late[T.name].values.tolist() == []
    assert ordered.rest()[T.name].values.tolist() == [2, 4]
    assert notes == {"too late, not counted: /t.temperature": 1}
