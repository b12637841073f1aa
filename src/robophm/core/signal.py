"""A signal is one number of one topic over time: ``/topic.field[2]``."""

from __future__ import annotations

import re
from typing import NamedTuple

from robophm.core.errors import SourceError

SECOND = 1_000_000_000
"""Nanoseconds in a second: a sample's time is an integer of nanoseconds."""

HOUR = 3600 * SECOND
"""Nanoseconds in an hour."""

CLOCK = "clock"
"""The signal by which a live source says that time went on although the robot said nothing."""

_TOPIC = re.compile(r"[^.\s\x00-\x1f]+\Z")
_FIELD = re.compile(r"[A-Za-z_]\w*(\[\d+\])?(\.[A-Za-z_]\w*(\[\d+\])?)*\Z", re.ASCII)


class Sample(NamedTuple):
    """One value of one signal. Ties in time are ordered by (signal, value), as the tuple compares."""

    time: int
    """Nanoseconds since the epoch."""
    signal: str
    """``/topic.field[2]``, or ``clock``."""
    value: float
    """In the unit of the message, unconverted; NaN where the message says so."""


def signal_name(topic: str, field: str) -> str:
    """The name of a signal, ``/topic.field[2]``.

    Raises SourceError where the field is not a path of names with optional indices, or the topic has a dot or blank.
    """
    if not _TOPIC.match(topic):
        raise SourceError(f"'{topic}' is not a topic; expected e.g. '/power/temperature', without dots and blanks")
    if not _FIELD.match(field):
        raise SourceError(
            f"field '{field}' of topic '{topic}' is not a field path; expected e.g. 'pose.x' or 'effort[2]'"
        )
    return f"{topic}.{field}"


def split_signal(signal: str) -> tuple[str, str]:
    """Topic and field of a signal name. Raises SourceError where there is no field."""
    topic, dot, field = signal.partition(".")
    if not dot or not _FIELD.match(field):
        raise SourceError(f"signal '{signal}' names no field; expected '/topic.field'")
    return topic, field


def any_element(field: str) -> str:
    """A field path for any index: ``effort[]`` for ``effort[2]``."""
    return re.sub(r"\[\d+\]", "[]", field)
