"""Receipt of live messages, common to all live sources: numbers get their time, and wait to be taken."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from operator import attrgetter
from queue import SimpleQueue
from typing import Protocol

from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, SECOND, Sample, split_signal
from robophm.transports.live.decoding import LARGE, Numbers, TopicDecoder
from robophm.transports.live.machine_time import MachineTime
from robophm.transports.live.simulated_time import SimulatedTime
from robophm.transports.signals.element_names import Names
from robophm.transports.signals.incidents import Incidents
from robophm.transports.signals.source import STAMP_LIMIT, Gap, LiveItem, LiveSource, Untimed, WholeMessage

CLOCK_TOPIC = "/clock"
"""The topic of time under use_sim_time (wiki.ros.org/Clock, design.ros2.org/articles/clock_and_time)."""

AHEAD = SECOND
"""Nanoseconds that a header stamp may be ahead of its receipt. Beyond it is another machine's clock, by which all that
others say would be late."""

QUEUE = 100_000
"""Samples that may wait to be taken; further ones are dropped and counted."""

MOST_WHOLE = 200
"""Whole messages that may wait."""

TICK = 0.5
"""Seconds between two clock samples, at most."""

TOGETHER = 0.002
"""Seconds in which what comes is taken together: it takes much less time than one by one."""

_clock_of = attrgetter("clock.sec", "clock.nanosec")


class Decoder(Protocol):
    """Reads the messages of one topic, ``topic``."""

    topic: str

    def read(self, raw: bytes, *, whole: bool) -> Numbers:
        """Return the numbers of one message; ``whole``: and the message. Raises where it is none."""


@dataclass
class Count:
    """Messages of a topic, and their receipt [ns]."""

    messages: int
    first: int
    last: int


class Receiver:
    """Gives messages their time; puts samples, those of the clock, and whole messages in order. All in one thread."""

    def __init__(
        self, notes: Incidents, put: Callable[[Sequence[LiveItem]], None], whole: Collection[str], *,
        simulated: bool, known_to: int | None = None,
    ) -> None:  # fmt: skip
        """``simulated``: nothing has a time before /clock is heard; otherwise the machine's clock counts until then.

        ``known_to``: the time to which the robot's past is known [ns], if it has one.
        """
        self.simulated = simulated
        """Whether receipt is the time of /clock, once that is heard: it may be published at any time."""
        self.whole = frozenset(whole)
        """Topics whose messages are wanted as they are."""
        self.counts: dict[str, Count] = {}
        self._notes = notes
        self._names = Names(notes, notes.lock)
        self._put = put
        self._told = 0
        """The latest clock sample."""
        self._latest = 0
        self._machine = MachineTime(known_to, notes.add)
        self._waits = simulated
        self._clock = SimulatedTime(lambda: known_to if simulated else self._machine.now() or known_to, notes.add)

    def messages(self, reading: Decoder, raws: Sequence[bytes], before: int | None) -> int | None:
        """Messages of one publisher have come, one after the other.

        ``before`` is the number in the sequence of the one before them, as is returned of the last.
        """
        topic, whole = reading.topic, reading.topic in self.whole
        for raw in raws:
            if self.simulated and topic == CLOCK_TOPIC and isinstance(reading, TopicDecoder):
                with suppress(Exception):  # it is counted below
                    self._set_clock(reading, raw)
            try:
                numbers = reading.read(raw, whole=whole)
            except Exception:  # rosbags lets struct, NumPy and memory errors of damaged messages through
                self._unreadable(topic)
            else:
                before = self._heard(topic, numbers, before)
        return before

    def _unreadable(self, topic: str) -> None:
        self.missing(topic, "unreadable message")
        if topic in self.whole and (receipt := self._receipt()):
            self._put([WholeMessage(receipt, topic, None)])

    def _heard(self, topic: str, numbers: Numbers, before: int | None) -> int | None:
        if numbers.sequence is not None and before is not None and numbers.sequence > before + 1:
            self.missing(topic, "sequence gap", numbers.sequence - before - 1)
        if not (receipt := self._receipt()):
            clock = CLOCK_TOPIC if self._waits else "the machine's clock"
            self._notes.add(f"before the first time of {clock}, dropped {topic}")
            return numbers.sequence
        if receipt < self._latest:
            self._notes.add(f"receipt time goes backwards on {topic}")
        self._latest = receipt
        count = self.counts.get(topic)
        if count is None:
            count = self.counts[topic] = Count(0, receipt, receipt)
        count.messages += 1
        count.last = receipt
        at = numbers.stamp + self._clock.offset if numbers.stamp else 0
        if at == 0 or not -STAMP_LIMIT <= at - receipt <= AHEAD:
            if numbers.values:
                self._notes.add(f"receipt time used for {topic}")
            at = receipt
        for signal in numbers.absent:
            self._notes.add(f"no element for {signal}")
        for signal, names in numbers.unnamed:
            self._names.missing(signal, names)
        for signal, name in numbers.at_index:
            self._names.at_index(signal, name)
        for signal in numbers.found:
            self._names.found(signal)
        heard: list[LiveItem] = [Sample(at, signal, value) for signal, value in numbers.values]
        if topic in self.whole:
            if numbers.message is None:
                self._notes.add(f"message on {topic} longer than {LARGE} bytes")
            heard.append(WholeMessage(receipt, topic, numbers.message))
        self._put(heard)
        return numbers.sequence

    def missing(self, topic: str, why: str, count: int = 1) -> None:
        """Count messages that did not come, or what may have cost some; what is heard has a gap here."""
        self._notes.add(f"{why} on {topic}", count)
        self._put([Gap(topic, why)])

    def tell(self) -> None:
        """Put a clock sample: silence is heard too."""
        if now := self._receipt():
            self._told = now
            self._put([Sample(now, CLOCK, math.nan if self._clock.now else self._machine.ahead)])
        else:
            self._put([Untimed()])

    def _receipt(self) -> int:
        """The time that what comes now gets; 0 before there is any."""
        return self._clock.now or (0 if self._waits else self._machine.now())

    def _set_clock(self, reading: TopicDecoder, raw: bytes) -> None:
        seconds, nanoseconds = _clock_of(reading.type.decode(raw))
        self._clock.hear(seconds * SECOND + nanoseconds)
        if self._clock.now - self._told >= SECOND:
            self.tell()


class Queue:
    """A queue of live items between threads, with a limit: what comes beyond it is dropped and counted.

    Threads that wake each other for every sample take longer for that than for the samples: what is put is handed on
    all at once, when ``hand_on`` says so.
    """

    def __init__(self, notes: Incidents, most: int) -> None:
        self._notes = notes
        self._most = most
        self._gathered: list[LiveItem] = []
        self._gaps: set[Gap] = set()
        """Gaps since there was room last."""
        self._waiting: SimpleQueue[list[LiveItem] | None] = SimpleQueue()
        self._put = self._taken = 0  # each by one thread alone
        self._whole_put = self._whole_taken = 0
        self._over = threading.Event()
        self._handing = threading.RLock()  # a signal may end it while we are in it

    def put(self, heard: Sequence[LiveItem]) -> None:
        """Queue all items of one message, or none of them; they can be taken after the next ``hand_on``."""
        whole = bool(heard) and isinstance(heard[-1], WholeMessage)
        if self._put - self._taken + len(heard) > self._most or (
            whole and self._whole_put - self._whole_taken >= MOST_WHOLE
        ):
            for one in heard:
                self._drop(one)
            return
        with self._handing:
            if self._gaps:
                self._put += len(self._gaps)
                self._gathered += sorted(self._gaps)
                self._gaps.clear()
            self._put += len(heard)
            self._whole_put += whole
            self._gathered += heard

    def _drop(self, one: LiveItem) -> None:
        if isinstance(one, Untimed):
            return
        if isinstance(one, Gap):
            self._gaps.add(one)
            return
        topic, what = (one.signal.partition(".")[0], one.signal) if isinstance(one, Sample) else (one.topic, one.topic)
        self._notes.add(f"queue full, dropped {what}")
        if topic != CLOCK:
            self._gaps.add(Gap(topic, "queue full"))

    def hand_on(self) -> None:
        """Make available to the taker all that has been put so far."""
        with self._handing:
            if self._gathered:
                self._waiting.put(self._gathered)
                self._gathered = []

    def end(self) -> None:
        """Let whoever takes have what is there, and no more."""
        self.hand_on()
        self._waiting.put(None)

    def close(self) -> None:
        """End taking at once, whatever still waits."""
        self._over.set()
        self._waiting.put(None)

    def taken(self, close: Callable[[], None]) -> Iterator[LiveItem]:
        """Yield the items until the queue is ended or the caller stops, which then calls ``close``."""
        try:
            while (some := self._waiting.get()) is not None:
                for heard in some:
                    if self._over.is_set():
                        return
                    self._taken += 1
                    if isinstance(heard, WholeMessage):
                        self._whole_taken += 1
                    yield heard
        finally:
            if not self._over.is_set():  # otherwise somebody else is closing, which may take longer
                close()


class _Closable(Protocol):
    def close(self) -> None: ...


class Run:
    """One call of ``listen``: its queue, and the resources that it closes in this order when it is over."""

    def __init__(self, queue: Queue, hearing: Receiver, *held: _Closable) -> None:
        self.hearing = hearing
        self._queue = queue
        self._held = held
        self._closing = threading.RLock()  # a signal may close while we are in it
        self._closed = False

    def heard(self) -> Iterator[LiveItem]:
        """Yield the items that were received, until the run ends."""
        return self._queue.taken(self.close)

    def end(self) -> None:
        """End after the items that have come so far."""
        self._queue.end()

    def close(self) -> None:
        """Close all that the run holds; closing twice does no harm."""
        self._queue.close()
        with self._closing:  # who comes second returns when it is done
            if not self._closed:
                self._closed = True
                for one in self._held:
                    one.close()


class ListeningSource(LiveSource):
    """The base of live sources: one run at a time, which can be told to end."""

    _run: Run | None = None
    _stopped = False  # before there was anything to end

    def _counted(self, topic: str) -> tuple[int, int | None, int | None]:
        """The messages that were heard on a topic since it is listened to, and the times of the first and the last."""
        count = self._run.hearing.counts.get(topic) if self._run else None
        return (count.messages, count.first, count.last) if count else (0, None, None)

    def stop(self) -> None:
        """End ``listen`` once all that has come so far has been taken; from any thread, and from a signal.

        Where nothing is listened to yet, the next ``listen`` ends at once.
        """
        if self._run:
            self._run.end()
        else:
            self._stopped = True

    def _begin(self, run: Run) -> None:
        """Make this run the one that ``stop`` ends."""
        self._run = run
        if self._stopped:
            self._stopped = False
            run.end()


def note_again(notes: Incidents, types: dict[str, str], topic: str, identity: str) -> None:
    """Note that a topic is heard again, and whether its type is another; ``types`` has the one before, then this."""
    before = types.get(topic)
    if before is not None:
        notes.add(f"connected again to {topic}")
        if before != identity:
            notes.add(f"type changed on {topic}")
    types[topic] = identity


def by_topic(signals: Collection[str]) -> dict[str, list[str]]:
    """Return the signals of each topic, without those of the clock. Raises SourceError where one has no topic of
    ROS."""
    wanted: dict[str, list[str]] = {}
    for signal in sorted({*signals} - {CLOCK}):
        topic, _ = split_signal(signal)
        if not topic.startswith("/"):
            raise SourceError(f"signal '{signal}' has no topic of ROS; expected it to begin with '/'")
        wanted.setdefault(topic, []).append(signal)
    return wanted


def tick_of(period: float) -> float:
    """Return the seconds between two clock samples: a whole part of the period, TICK at most."""
    return period / math.ceil(period / TICK)
