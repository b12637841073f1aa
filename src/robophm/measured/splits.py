"""Overviews of many recordings, of which those that are alike and follow each other are one."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from robophm.measured.overview import Overview, named, timed
from robophm.measured.recordings import Recorded
from robophm.transports.recordings.files import holds_messages

APART = 0.1
"""Part of the time of a file within which of its end the one that follows it begins, or else within two intervals of
its fastest topic."""

NAMING = 12
"""Files of those that are one, as far apart, whose messages are looked into for names."""


@dataclass
class Splits:
    """A recording at a glance, or some that are alike and follow each other, as a recorder makes one each minute."""

    seen: Overview
    """The overview, as of one drive."""
    files: tuple[str, ...]
    """Names of the recordings, in order of time."""
    with_topic: Counter[str]
    """Number of the recordings that have each topic."""


def splits_of(
    each: Sequence[Recorded], gap: int | None = None, advance: Callable[[int, int], None] = lambda done, of: None
) -> list[Splits]:
    """Return overviews of recordings, ``gap`` as of ``overview``; what is alike and follows each other is one of them.

    Those are files of messages in one folder whose names differ in numbers alone. In the order of those each has at
    least half of the topics of the one before, of the same types, and begins when that ends. ``advance`` is told how
    many of how many are done.

    Raises SourceError where one is missing or no recording.
    """
    alone = _timed(each, gap, advance)
    runs = _runs(each, alone)
    return [_joined([each[one] for one in run], [alone[one] for one in run], gap) for run in runs]


def drives_of(each: Sequence[Recorded], advance: Callable[[int, int], None] = lambda done, of: None) -> list[Recorded]:
    """Return recordings, of which those that ``splits_of`` takes as one are one drive.

    Raises SourceError where one is missing or no recording.
    """
    runs = _runs(each, _timed(each, None, advance)) if len(each) > 1 else [[one] for one in range(len(each))]
    return [_as_one([each[one] for one in run]) for run in runs]


def _timed(each: Sequence[Recorded], gap: int | None, advance: Callable[[int, int], None]) -> list[Overview]:
    alone = []
    for done, one in enumerate(each):
        advance(done, len(each))
        alone.append(timed(one, gap))
    return alone


def _runs(each: Sequence[Recorded], alone: Sequence[Overview]) -> list[list[int]]:
    """The numbers of recordings that are alike and follow each other, those of one drive in order of time."""
    runs: list[list[int]] = []
    for number in sorted(range(len(each)), key=lambda one: (_place(each[one]), _numbers(each[one]), one)):
        last = runs[-1][-1] if runs else None
        if last is not None and _follows(each[last], alone[last], each[number], alone[number]):
            runs[-1].append(number)
        else:
            runs.append([number])
    return sorted(runs, key=min)


def _place(one: Recorded) -> tuple[str, str]:
    """The folder of a recording, and its name without the numbers in it."""
    path = one.paths[0]
    return str(path.parent), re.sub(r"\d+", "#", path.name)


def _numbers(one: Recorded) -> list[int]:
    """The numbers in the name of a recording: 9 is before 10, and what one robot recorded before another's."""
    return [int(number) for number in re.findall(r"\d+", one.paths[0].name)]


def _follows(before: Recorded, heard: Overview, after: Recorded, then: Overview) -> bool:
    if not heard.span or not then.span or _place(before) != _place(after):
        return False
    begin, end = heard.span
    interval = min((topic.interval for topic in heard.topics if topic.interval), default=0)
    if abs(then.span[0] - end) > max(APART * (end - begin), 2 * interval):
        return False
    shared = before.topics.keys() & after.topics.keys()
    return (
        2 * len(shared) >= len(before.topics.keys() | after.topics.keys())
        and all(before.topics[topic] == after.topics[topic] for topic in shared)
        and all(map(holds_messages, before.paths + after.paths))
    )


def _joined(run: Sequence[Recorded], alone: Sequence[Overview], gap: int | None) -> Splits:
    having = Counter(topic for one in run for topic in one.topics)
    names = tuple(one.name for one in run)
    if len(run) == 1:
        return Splits(named(alone[0], run[0].paths), names, having)
    whole = timed(_as_one(run), gap)
    return Splits(named(whole, [run[one].paths[0] for one in _looked_into(run)]), names, having)


def _as_one(run: Sequence[Recorded]) -> Recorded:
    if len(run) == 1:
        return run[0]
    paths = tuple(path for one in run for path in one.paths)
    topics = {topic: kind for one in reversed(run) for topic, kind in one.topics.items()}
    lost = tuple(what for one in run for what in one.lost)
    name = f"{len(run):,} files, {run[0].name} … {Path(run[-1].name).name}"
    return Recorded(name, paths, dict(sorted(topics.items())), lost)


def _looked_into(run: Sequence[Recorded]) -> Iterable[int]:
    """Files as far apart, and the first with each topic."""
    firsts = {topic: number for number, one in reversed([*enumerate(run)]) for topic in one.topics}
    return sorted({number * len(run) // NAMING for number in range(NAMING)} | {*firsts.values()})
