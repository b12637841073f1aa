"""Samples one by one out of columns of signals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from robophm.core.signal import Sample, split_signal
from robophm.transports.signals.source import SignalColumns

_STEP = 4096
"""Samples that are made at once: lists of floats are large."""


def samples_in_order(columns: Mapping[str, SignalColumns]) -> Iterator[Sample]:
    """The samples in order of time; of one time message by message of a topic, each in the order of its signals."""
    signals = sorted(columns)
    if not signals:
        return
    topics = {topic: number for number, topic in enumerate(sorted({split_signal(signal)[0] for signal in signals}))}
    lengths = [len(columns[signal].times) for signal in signals]
    times = np.concatenate([columns[signal].times for signal in signals])
    values = np.concatenate([columns[signal].values for signal in signals])
    rank = np.repeat(np.arange(len(signals)), lengths)
    message = np.concatenate([np.arange(length) for length in lengths])
    topic = np.repeat([topics[split_signal(signal)[0]] for signal in signals], lengths)
    order = np.lexsort((rank, message, topic, times))
    for first in range(0, len(order), _STEP):
        rows = order[first : first + _STEP]
        for time, number, value in zip(times[rows].tolist(), rank[rows].tolist(), values[rows].tolist(), strict=True):
            yield Sample(time, signals[number], value)
