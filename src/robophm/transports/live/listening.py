"""Listening to a running robot for a while: the last value of each number of each topic."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from robophm.core.signal import CLOCK, Sample, split_signal
from robophm.transports.signals.element_names import add_names, names_in
from robophm.transports.signals.source import LiveSource, TopicInfo, WholeMessage


@dataclass(frozen=True)
class HeardTopic:
    """One topic as it was heard in the while."""

    info: TopicInfo
    fields: Sequence[str]
    """Fields that were listened to; for an array its first element, ``effort[0]``."""
    values: Mapping[str, float]
    """Last value of each field of which one was heard."""
    names: Mapping[str, Sequence[str]]
    """Names that messages give the elements of an array, by its field, ``effort[]``."""


def listen_for(source: LiveSource, seconds: float) -> list[HeardTopic]:
    """Return what comes on all topics in so many seconds, all numbers but the stamps by which messages are ordered.

    Raises SourceError as ``listen``.
    """
    fields: dict[str, Sequence[str]] = {}
    values: dict[str, dict[str, float]] = {}
    names: dict[str, dict[str, list[str]]] = {}
    infos = source.topics()
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        fields = {info.topic: _numbers(info) for info in infos}
        arrays = [topic for topic, some in fields.items() if not source.announced or any("[" in one for one in some)]
        for heard in source.listen([f"{topic}.{field}" for topic, some in fields.items() for field in some], arrays):
            if isinstance(heard, Sample) and heard.signal != CLOCK:
                topic, field = split_signal(heard.signal)
                values.setdefault(topic, {})[field] = heard.value
            elif isinstance(heard, WholeMessage) and heard.message is not None:
                add_names(names.setdefault(heard.topic, {}), names_in(heard.message))
            elif not source.announced and len(found := source.topics()) > len(infos):
                infos = found  # what was never heard before could not be asked for
                break
            if time.monotonic() >= end:  # clock samples come in silence too
                break
    return [
        HeardTopic(info, fields.get(info.topic, ()), values.get(info.topic, {}), names.get(info.topic, {}))
        for info in source.topics()
    ]


def _numbers(info: TopicInfo) -> Sequence[str]:
    return [field.replace("[]", "[0]") for field in info.fields if not field.startswith(("header.stamp", "header.seq"))]
