"""Alarms in words."""

from __future__ import annotations

from robophm.health.alarms import Alarm
from robophm.report.words import moment_text


def alarm_text(one: Alarm) -> str:
    """A line that says that an alarm has begun, is over, or that nobody knows whether it goes on."""
    if one.end is not None:
        return f"alarm over at {moment_text(one.end)}: {one.what}: {one.ended_by}"
    if one.doubt and one.doubt not in one.cause:
        return f"alarm {one.what}: whether it goes on is not known, it {one.doubt}"
    return f"alarm ({one.severity}) since {moment_text(one.begin)}: {one.cause}"
