"""Events in a robot's past, told from its reports and its ledger as they are kept."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from itertools import takewhile
from typing import Any, Literal, NamedTuple

Kind = Literal[
    "breach",
    "breach ended",
    "silence",
    "silence ended",
    "failure",
    "failure struck out",
    "replacement",
    "repair",
    "design change",
    "restart",
    "alarm",
    "alarm ended",
]

_STALE = "stale "

_SERVICES: dict[str, Kind] = {"failed": "failure", "replaced": "replacement", "repaired": "repair",
                              "struck out": "failure struck out"}  # fmt: skip

WORDS = {"struck out": "had not failed, struck out"}
"""Words for kinds of services that are none by themselves."""


class Event(NamedTuple):
    """One thing that happened; there is one of each kind, time and subject."""

    time: int
    """When [ns since the epoch]: of a silence when the signal was heard last, of a breach, of what has ended and of a
    signal that never spoke the report that was the first to tell of it."""
    kind: Kind
    subject: str
    """Subject of the event: a figure of a module, a signal, a failure mode, a part, an alarm; "" the robot."""
    said: str
    """Words for people."""

    def to_json(self) -> dict[str, Any]:
        """Return the event as plain values, its moment in words too."""
        return {**self._asdict(), "at": datetime.fromtimestamp(self.time // 10**9, UTC).isoformat()}


def events_between(before: Mapping[str, Any] | None, after: Mapping[str, Any]) -> Iterator[Event]:
    """Yield what a health report as JSON tells of that the one before, None for the first, does not."""
    time = after["time"]
    was, now = _breaches(before or {}), _breaches(after)
    for subject in now.keys() - was.keys():
        yield Event(time, "breach", subject, now[subject])
    for subject in was.keys() - now.keys():
        yield Event(time, "breach ended", subject, f"no longer so: {was[subject]}")
    was_silent, now_silent = _silent(before or {}), _silent(after)
    heard_last = after.get("silent", {})
    for signal in now_silent - was_silent:
        yield Event(heard_last.get(signal) or time, "silence", signal, f"{signal} is silent")
    for signal in was_silent - now_silent:
        yield Event(time, "silence ended", signal, f"{signal} is heard again")
    if before and before.get("design_hash") != after.get("design_hash"):
        yield Event(time, "design change", "", "another state of the design")


def events_of(ledger: Mapping[str, Any]) -> Iterator[Event]:
    """Yield what a ledger as JSON tells of: its services and the changes of its design."""
    services = ledger.get("services", ())
    for (time, mode, kind, failed, *_), said in zip(
        services, ledger.get("said") or [("", "")] * len(services), strict=True
    ):
        done: Kind = _SERVICES[kind]
        after = " after it had failed" if failed and done != "failure" else ""
        by = f"{', told' * (done == 'failure')} by {said[0]}" if said[0] else ""
        note = f": {said[1]}" if said[1] else ""
        yield Event(time, done, mode, f"{_named(mode)} {WORDS.get(kind, kind)}{after}{by}{note}")
    for time, part, kind, before in ledger.get("changes", ()):
        yield Event(time, "design change", part, f"{part}: {kind}{f', before {before}' if before else ''}")


def events_of_alarms(alarms: Iterable[Mapping[str, Any]]) -> Iterator[Event]:
    """Yield the begin of each alarm of a log, and its end where it has ended."""
    for one in alarms:
        yield Event(one["begin"], "alarm", one["what"], one["cause"])
        if one["end"] is not None:
            yield Event(one["end"], "alarm ended", one["what"], one["ended_by"])


def latest_events(events: Iterable[Event], start: int, end: int, most: int) -> list[Event]:
    """Return those of some events from a time until before another [ns], oldest first: so many, the latest."""
    return sorted((one for one in events if start <= one.time < end), reverse=True)[:most][::-1]


def _named(mode: str) -> str:
    """A failure mode as its key names it, without the clock and the scaling of its sums."""
    return re.sub(r" \([^()]*, (age|hazard) scaling.*$", "", mode)


def _breaches(report: Mapping[str, Any]) -> dict[str, str]:
    """The breaches of a report by figure, whose value now is not what they are told apart by."""
    found = {}
    for one in report.get("subjects", ()):
        path = "" if one.get("kind") == "robot" else f"{one.get('path')}: "
        for words in one.get("breaches", ()):
            figure = " ".join(takewhile(lambda word: not word[0].isdigit(), words.split()))
            found[path + figure] = path + words
    return found


def _silent(report: Mapping[str, Any]) -> set[str]:
    flags = (flag for one in report.get("subjects", ()) for flag in one.get("flags", ()))
    return {flag.removeprefix(_STALE) for flag in flags if flag.startswith(_STALE)}
