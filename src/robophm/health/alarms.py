"""Alarms on limits, on parts that have failed, on wear, and on signals that change or fall silent: begin and end."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

from robophm.health.limits import LimitedValue, Severity
from robophm.health.report import HealthReport
from robophm.health.subject import FAILED


@dataclass(frozen=True)
class Alarm:
    """Something that is not well, from its begin to its end; times of the samples [ns since the epoch]."""

    what: str
    """Name that no other alarm of the robot has: what it is of, its kind and its severity."""
    path: str
    """Path of a module, a part or a failure mode, or name of a signal; empty for the robot."""
    severity: Severity
    begin: int
    cause: str
    """Why it began, in words."""
    end: int | None = None
    """Time when it ended; None while it goes on."""
    doubt: str = ""
    """The reason why nobody knows at present whether it goes on; empty where that is known."""
    ended_by: str = ""
    """Why it ended, in words."""
    number: int = 0
    """Number in its log; 0 before it is kept."""
    acknowledged_by: str = ""
    """The person who has taken note of it; empty as long as nobody has."""
    acknowledged_at: int | None = None
    """Time of that, by the clock of the machine on which it was said [ns since the epoch]."""

    def to_json(self) -> dict[str, Any]:
        """Return the alarm as plain values for JSON."""
        return asdict(self)

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Alarm:
        """Return an alarm that was kept as plain values."""
        return cls(**data)


class _Condition(NamedTuple):
    """What may be an alarm, as it is now."""

    what: str
    path: str
    severity: Severity
    begins: bool
    """Whether there is an alarm, or will be after the delay."""
    ends: bool
    """Whether an alarm that goes on is over."""
    words: str
    doubt: str = ""
    delay: int = 0


class Alarms:
    """The alarms of one robot, from one report to the next: what one look after the other makes of them.

    They follow from the reports alone, and the reports from the samples: the same samples give the same alarms.
    """

    def __init__(self, going_on: Iterable[Alarm] = ()) -> None:
        """Go on from the alarms that were open before."""
        self.open = {one.what: one for one in going_on}
        """The alarms that go on, by what they are."""
        self._since: dict[str, int] = {}  # for how long conditions of alarms that have not begun have held
        self._looked: tuple[int, float] | None = None
        """Time and hours of operation of the last look."""
        self._on = True

    def look(self, report: HealthReport) -> list[Alarm]:
        """Take a report, and return the alarms that have begun, ended or changed with it."""
        if report.time is None:
            return []
        hours = report.clocks["operating"]
        if self._looked and report.time > self._looked[0]:
            self._on = hours > self._looked[1]
        self._looked = report.time, hours
        changed, seen = [], set()
        for one in _conditions(report, self.open, is_on=self._on):
            seen.add(one.what)
            if (alarm := self._next(one, report.time)) is not None:
                changed.append(alarm)
        for what in self.open.keys() - seen:
            ended = replace(self.open.pop(what), end=report.time, ended_by=_GONE, doubt="")
            changed.append(ended)
        self._since = {what: time for what, time in self._since.items() if what in seen}
        return changed

    def numbered(self, kept: Iterable[Alarm]) -> None:
        """Take the numbers that a log has given to alarms that go on."""
        self.open.update({one.what: one for one in kept if one.what in self.open and one.end is None})

    def _next(self, one: _Condition, time: int) -> Alarm | None:
        """The alarm on a condition, where the look at it has changed anything of it."""
        alarm = self.open.get(one.what)
        if alarm is None:
            if not one.begins:
                self._since.pop(one.what, None)
                return None
            if time - self._since.setdefault(one.what, time) < one.delay:
                return None
            del self._since[one.what]
            cause = f"{one.words}; it {one.doubt}" if one.doubt else one.words
            self.open[one.what] = alarm = Alarm(one.what, one.path, one.severity, time, cause, doubt=one.doubt)
            return alarm
        if one.ends and not one.doubt:
            del self.open[one.what]
            return replace(alarm, end=time, ended_by=one.words, doubt="")
        if one.doubt != alarm.doubt:  # what rests on silence does not end, and it says so
            self.open[one.what] = alarm = replace(alarm, doubt=one.doubt)
            return alarm
        return None


_GONE = "nothing looks for it any more: the design no longer states it, or what it was of is gone"


def _conditions(report: HealthReport, open_: Collection[str], *, is_on: bool) -> Iterator[_Condition]:
    for part in report.components:
        lost = [flag.removeprefix(FAILED) for flag in part.flags if flag.startswith(FAILED)]
        if lost or f"failure of {part.path}" in open_:
            words = f"{', '.join(lost)} was told to have failed" if lost else f"{part.path} was replaced or repaired"
            yield _Condition(f"failure of {part.path}", part.path, "error", bool(lost), not lost, words)
    silent: dict[str, list[LimitedValue]] = {}
    for one in report.limited_values:
        doubt = one.silence
        if one.figure == "signal" and one.value is None:
            silent.setdefault(one.path, []).append(one)
            doubt = f"rests on silence of {one.path}"
        yield _Condition(one.key, one.path, one.severity, one.broken, one.clear, one.said, doubt, one.level.delay)
        if one.figure == "signal":
            silent.setdefault(one.path, [])
    for signal, limits in silent.items():
        unknown = " or ".join(one.beyond for one in limits)
        words = f"{signal} is silent: whether it is {unknown} is not known" if limits else f"{signal} is heard again"
        yield _Condition(f"warn {signal} silent", signal, "warn", bool(limits) and is_on, not limits, words)
    for worn in report.wear:
        reached: Severity = "error" if worn.state == "reached" else "warn"
        words = f"wear of {worn.mode}: {worn.says}"
        yield _Condition(f"wear of {worn.mode}", worn.mode, reached, worn.critical, not worn.critical, words)
        change = worn.alarming
        words = f"{worn.signal} of {worn.mode} {change.words if change else 'is as it was at first'}"
        yield _Condition(f"change of {worn.mode}", worn.mode, "warn", change is not None, change is None, words)
    doubted = {one.about.signal: one.about for one in report.doubts}
    for signal in report.design.signals:
        about = doubted.get(signal)
        words = f"{signal} {about.why}" if about else f"{signal} is not doubtful any more"
        yield _Condition(f"doubt of {signal}", signal, "warn", about is not None, about is None, words)
