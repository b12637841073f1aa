"""A robot that runs at a glance, where there is no recording: its topics, and values of what a design could bind."""

from __future__ import annotations

import math
import time
from dataclasses import replace

from robophm.core.signal import Sample
from robophm.drafting.seen import MOST_SIGNALS, Seen, SeenTopic, bindable, plain_type
from robophm.measured.overview import Topic
from robophm.transports.live.listening import HeardTopic, listen_for
from robophm.transports.signals.source import LiveSource


def hear(source: LiveSource, seconds: float) -> Seen:
    """Listen for so many seconds: half of them for topics and names, then for values of the signals that they have.

    Mean speeds of joints, by which gears are drafted, are told by recordings alone. Raises SourceError where nothing
    can be heard.
    """
    heard = listen_for(source, seconds / 2)
    sought = {one.name: one for one in bindable([_shown(one) for one in heard], {})}
    spans = dict.fromkeys(list(sought)[:MOST_SIGNALS], (math.inf, -math.inf, 0))
    end = time.monotonic() + seconds / 2
    for item in source.listen(list(spans), ()) if spans else ():
        if isinstance(item, Sample) and item.signal in spans:
            low, high, count = spans[item.signal]
            spans[item.signal] = min(low, item.value), max(high, item.value), count + 1
        if time.monotonic() >= end:  # clock samples come in silence too
            break
    topics = tuple(SeenTopic(one.info.topic, plain_type(one.info.type), one.info.rate) for one in heard)
    signals = tuple(
        replace(sought[name], lowest=low, highest=high, samples=count)
        for name, (low, high, count) in spans.items()
        if count
    )
    return Seen((), topics, signals)


def _shown(one: HeardTopic) -> Topic:
    """A topic as a recording would show it."""
    names = {array: list(of) for array, of in one.names.items()}
    return Topic(one.info.topic, one.info.type, dict.fromkeys(one.info.fields), names)
