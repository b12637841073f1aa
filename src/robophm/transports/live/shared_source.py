"""One live source that several robots of one design are heard by, each below its own namespace."""

from __future__ import annotations

import fnmatch
import threading
import time
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from queue import Full
from queue import Queue as Waiting

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import CLOCK, Sample
from robophm.transports.live.one_robot import namespace_of
from robophm.transports.live.renamed import RenamedSource
from robophm.transports.signals.source import LiveItem, LiveSource, TopicInfo, Untimed

MOST_WAITING = 1000
"""Times that something may be handed to one robot and wait; who is as far behind lets the others wait for a moment."""

TOGETHER = 0.05
"""Seconds in which samples are gathered before they are handed on, at the latest with the next clock sample."""


def robots_of(source: LiveSource, asked: str) -> list[str]:
    """Return the names of robots: those in a list with commas, and those that are heard now and match a pattern.

    Raises SourceError where a name is none, or nobody matches.
    """
    found: dict[str, None] = {}
    for one in (part.strip().strip("/") for part in asked.split(",")):
        if not {*one} & {*"*?["}:
            found[namespace_of(one)[1:]] = None
            continue
        depth = one.count("/") + 1
        heard = {"/".join(steps[1 : depth + 1]) for info in source.topics()
                 if len(steps := info.topic.split("/")) > depth + 1}  # fmt: skip
        matching = fnmatch.filter(sorted(heard), one)
        if not matching:
            raise SourceError(
                f"no robot that is heard now matches '{one}'{nearest(one, sorted(heard))}; expected one, or a list of "
                "names, amr_1,amr_2, which are waited for"
            )
        found |= dict.fromkeys(matching)
    return list(found)


class EndedBeforeError(SourceError):
    """Robots that are watched together are not, since one of them could not be."""


class SharedSource:
    """Shares a live source among robots: listened to once, when all of them listen, and each gets what is its own."""

    def __init__(self, source: LiveSource, robots: Sequence[str]) -> None:
        self._source = source
        self.parts = {robot: _Part(self, source, robot) for robot in robots}
        """The source of each robot, whose topics are named from the robots' namespaces, with them."""
        self._ready = threading.Barrier(len(robots), self._listen)
        self._asked: dict[str, tuple[Collection[str], Collection[str]]] = {}
        self._thread: threading.Thread | None = None
        self._mistake: SourceError | None = None

    def join(self, robot: str, signals: Collection[str], topics: Collection[str]) -> None:
        """Wait until all robots listen. Raises SourceError where one asks for what cannot be, or has ended before."""
        self._asked[robot] = signals, topics
        try:
            self._ready.wait()
        except threading.BrokenBarrierError:
            raise self._mistake or EndedBeforeError("another robot's watch has ended before it began") from None

    def leave(self) -> None:
        """Let nobody wait for a robot that has ended."""
        self._ready.abort()

    def _listen(self) -> None:
        """Listen for all robots; called by the last that asks."""
        known = [part.known_to for part in self.parts.values() if part.known_to is not None]
        self._source.known_to = max(known, default=None)
        signals = dict.fromkeys(s for some, _ in self._asked.values() for s in some if s != CLOCK)
        topics = {topic for _, some in self._asked.values() for topic in some}
        try:
            heard = self._source.listen(signals, topics)
        except SourceError as error:
            self._mistake = error
            raise
        self._thread = threading.Thread(target=self._hand_out, args=(heard,), name="robophm robots", daemon=True)
        self._thread.start()

    def _hand_out(self, heard: Iterator[LiveItem]) -> None:
        everyone, due = [*self.parts.values()], 0.0
        by_signal = {s: self.parts[robot] for robot, (some, _) in self._asked.items() for s in some if s != CLOCK}
        by_topic = {topic: self.parts[robot] for robot, (_, some) in self._asked.items() for topic in some}
        by_topic |= {signal.partition(".")[0]: part for signal, part in by_signal.items()}
        for one in heard:
            if isinstance(one, Sample) and one.signal != CLOCK:
                some = [by_signal[one.signal]]
            elif isinstance(one, Sample | Untimed):
                some = everyone
            else:
                some = [by_topic[one.topic]] if one.topic in by_topic else []
            for part in some:
                part.gathered.append(one)
            if isinstance(one, Sample) and one.signal != CLOCK and time.monotonic() < due:
                continue  # robots whose threads are woken for every sample take longer for that than for the samples
            due = time.monotonic() + TOGETHER
            for part in everyone:
                part.hand_on()
        for part in everyone:
            part.gathered.append(None)
            part.hand_on()


class _Part(RenamedSource):
    """What one robot hears of a source that is shared, by whole names."""

    def __init__(self, shared: SharedSource, source: LiveSource, robot: str) -> None:
        super().__init__(source, str)
        self._shared, self._robot = shared, robot
        self.gathered: list[LiveItem | None] = []
        """Items that are handed on next, None behind the last of all."""
        self._waiting: Waiting[list[LiveItem | None]] = Waiting(MOST_WAITING)
        self._gone = False
        self._notes: Counter[str] | None = None
        """Notes at the end, to which whoever listened adds."""

    @property
    def notes(self) -> Counter[str]:  # type: ignore[override]  # made of the source's, less those of others
        """Return the notes on topics of this robot, and on what concerns all."""
        if self._notes is not None:
            return self._notes
        others = [f"/{robot}/" for robot in self._shared.parts if robot != self._robot]
        notes: Mapping[str, int] = self._source.notes.copy()
        return Counter({what: n for what, n in notes.items() if not any(root in what for root in others)})

    def topics(self) -> list[TopicInfo]:
        """Return all topics of the source."""
        return self._source.topics()

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield what is this robot's, once all robots listen. Raises SourceError as the source does."""
        self._shared.join(self._robot, signals, topics)
        return self._heard()

    def _heard(self) -> Iterator[LiveItem]:
        while True:
            for one in self._waiting.get():
                if one is None:
                    self._notes = self.notes
                    return
                yield one

    def hand_on(self) -> None:
        """Hand what was gathered to the robot; who is gone is left alone."""
        some, self.gathered = self.gathered, []
        while some and not self._gone:
            try:
                self._waiting.put(some, timeout=0.5)
                return
            except Full:
                continue

    def close(self) -> None:
        """Let nobody wait for this robot; the source is closed by whoever opened it."""
        self._gone = True
        self._shared.leave()
