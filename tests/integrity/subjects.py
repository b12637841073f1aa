"""What is cut off or killed while it works: a journal, a store, a watch, a replay, a service; and how each is judged.

Each goes on in a folder where it was, and says how far it is. What it left is judged by plain lists of what went in.
"""

from __future__ import annotations

import tempfile
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import robophm.monitoring.block_monitor
import robophm.monitoring.live_loop
import robophm.monitoring.replay
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.design.file import parse
from robophm.monitoring.live_loop import watch
from robophm.monitoring.replay import replay
from robophm.stores import restore_store
from robophm.stores.events import Event
from robophm.stores.memory import MemoryStore
from robophm.stores.service_requests import ServiceRequest
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Progress, Store
from robophm.transports.recordings.journal import Journal, JournalRecording
from robophm.transports.signals.source import SignalSource, TopicInfo
from robophm.web.monitoring import Monitoring
from robophm.web.sources import Choice, choices

from .marking import Marks

BEGIN = 1_795_000_020 * SECOND
SIGNALS = ("/cold.temperature", "/hot.temperature")
CLOCK_EVERY = 10
"""Samples between two of the clock, at each of which a journal hands its lines to the system."""
PART = 4000
"""Bytes of a journal from which on it goes on in a new file, so that many are begun."""

DESIGN = """\
schema_version: 1
name: R
max_gap: 100 s
acceleration: {model: q10, reference_temperature: 25 degC}
components:
  hot: {rate: 0.01 /h, signals: {temperature: {topic: /hot, field: temperature, max_age: 60 s}}}
  cold: {rate: 0.02 /h, signals: {temperature: {topic: /cold, field: temperature, max_age: 60 s}}}
"""
ROBOT = parse(DESIGN)

Lost = Sequence[tuple[int, int]]
"""Stretches of what was heard that may be lost: from the first until before the second."""


def sample(number: int) -> Sample:
    """The sample of a number: one a second, each value once."""
    at = BEGIN + number * SECOND
    if number % CLOCK_EVERY == CLOCK_EVERY - 1:
        return Sample(at, CLOCK, 0.0)
    return Sample(at, SIGNALS[number % 2], 20 + number / 7)


class Subject(ABC):
    """Something that writes to a folder, and goes on where it was."""

    name: str
    length: int
    """Number of samples, or saves, after which it is done."""
    runs = 3
    """Runs of which it is made when no power is cut."""

    def prepare(self, folder: Path) -> None:
        """Put what it needs into an empty folder."""
        (folder / "robot.yaml").write_text(DESIGN)

    @abstractmethod
    def work(self, folder: Path, marks: Marks, begin: int, end: int) -> None:
        """Go on, with what comes from one number until before another."""

    @abstractmethod
    def judge(self, folder: Path, heard: int, lost: Lost) -> None:
        """Raise AssertionError where more is lost, something counts twice, or cannot be opened and gone on with."""


class OfJournal(Subject):
    """A journal alone."""

    name, length = "journal", 600

    def work(self, folder: Path, marks: Marks, begin: int, end: int) -> None:
        """Write samples, and sync once in a while."""
        with Journal(folder / "run.journal", SIGNALS, part_size=PART) as journal:
            for number in range(begin, end):
                marks.say("heard", number + 1)
                journal.write(one := sample(number))
                if one.signal == CLOCK:
                    marks.say("flushed", number + 1)
                if number % 100 == 99:
                    journal.sync()
                    marks.say("kept", number + 1)
        marks.say("kept", end)

    def judge(self, folder: Path, heard: int, lost: Lost) -> None:
        """Read it, and go on behind it."""
        path = folder / "run.journal"
        if not path.exists():  # it was about to go on in a new file, or had not begun
            Journal(path, SIGNALS, part_size=PART).close()
        there = journaled(path) if path.stat().st_size else []
        with Journal(path, SIGNALS, part_size=PART) as journal:  # the next run goes on, whatever it finds
            journal.write(sample(heard))
        is_told_once(journaled(path)[:-1], heard, lost)
        assert journaled(path) == [*there, sample(heard)]


class OfWatch(Subject):
    """The live loop, with journal and store."""

    name, length = "watch", 600

    def work(self, folder: Path, marks: Marks, begin: int, end: int) -> None:
        """Watch a robot that says one sample after the other."""
        robophm.monitoring.live_loop.SAVE_EVERY = 0.01
        source = Said(marks, begin, end)
        with (
            Marking(folder / "past.db", lambda _: marks.say("kept", marks["heard"])) as store,
            Journal(folder / "run.journal", ROBOT.signals, part_size=PART) as journal,
        ):
            watch(ROBOT, source, store=store, journal=journal, period=10.0)

    def judge(self, folder: Path, heard: int, lost: Lost) -> None:
        """What is in the journal is what was heard, and the ledger is that of the journal, once."""
        path = folder / "run.journal"
        with SqliteStore(folder / "past.db") as store, Journal(path, ROBOT.signals) as journal:
            watch(ROBOT, Said(Marks(), 0, 0), store=store, journal=journal, period=10.0)
            found = store.ledger("R")
        there = journaled(path)
        is_told_once(there, heard, lost)
        if any(one.signal != CLOCK for one in there):
            again = MemoryStore()
            replay(ROBOT, path, store=again, period=10.0)
            assert found == again.ledger("R"), "the ledger is not that of the journal"
        assert restore_store(folder / "past.db") is None


class OfStore(Subject):
    """A store alone: ledgers, progress, reports, events, alarms and requests."""

    name, length = "store", 60

    def work(self, folder: Path, marks: Marks, begin: int, end: int) -> None:
        """Save, and keep alarms and requests between."""
        with SqliteStore(folder / "past.db") as store:
            for number in range((store.ledger("R") or {"saves": 0})["saves"], end):
                marks.say("heard", number + 1)
                save(store, number)
                marks.say("flushed", number + 1)
                marks.say("kept", number + 1)

    def judge(self, folder: Path, heard: int, lost: Lost) -> None:
        """All of each save is there, or nothing, and it is gone on with."""
        first = min((begin for begin, _ in lost), default=heard)
        with SqliteStore(folder / "past.db") as store:
            done = (store.ledger("R") or {"saves": 0})["saves"]
            assert first <= done <= heard, (first, done, heard)
            history = store.history("R")
            assert store.progress("R", "drive").position == done
            assert [one["time"] - BEGIN for one in history.reports()] == [*range(done)]
            begun = [one.time - BEGIN for one in history.events() if one.kind == "restart"]
            assert begun == [*range(done)]
            assert len(history.figures(points=10_000).times) == done
            alarms = sorted(one["begin"] - BEGIN for one in store.alarm_log("R").alarms())
            assert alarms in ([*range(done)], [*range(done + 1)])
            waiting = [one.key for one in store.service_requests("R").waiting()]
            asked = [f"{number}" for number in range(done + 1) if number % 5 == 0]
            assert waiting in (asked, asked[: (done + 4) // 5])
            for _ in range(2):
                save(store, done)
                done += 1
        assert restore_store(folder / "past.db") is None


class OfReplay(Subject):
    """A replay of a recording into a store."""

    name, length, runs = "replay", 1000, 1

    def __init__(self) -> None:
        self._undisturbed = MemoryStore()

    def prepare(self, folder: Path) -> None:
        """Lay a recording."""
        super().prepare(folder)
        lines = [f"{BEGIN / SECOND + i:.0f},{20 + i / 700},{30 - i / 900}\n" for i in range(self.length)]
        (folder / "drive.csv").write_text("time,/hot.temperature,/cold.temperature\n" + "".join(lines))

    def work(self, folder: Path, marks: Marks, begin: int, end: int) -> None:
        """Replay it, and say how far it is once that is kept."""
        robophm.monitoring.replay.SAVE_EVERY = 0.005
        robophm.monitoring.block_monitor.ENOUGH = 100
        with Marking(folder / "past.db", lambda ledger: marks.say("kept", seconds_in(ledger))) as store:
            replay(ROBOT, folder / "drive.csv", store=store, period=10.0, report_every=60)
        marks.say("heard", self.length)

    def judge(self, folder: Path, heard: int, lost: Lost) -> None:
        """Replay it again: the ledger is as if it had been done once, without an end on the way."""
        if not self._undisturbed.robots():
            replay(ROBOT, folder / "drive.csv", store=self._undisturbed, period=10.0, report_every=60)
        self._has(folder, lost)
        with SqliteStore(folder / "past.db") as store:
            replay(ROBOT, folder / "drive.csv", store=store, period=10.0, report_every=60)
            assert store.ledger("R") == self._undisturbed.ledger("R"), "the ledger is another"
            assert [*store.history("R").reports()] == [*self._undisturbed.history("R").reports()]
        assert restore_store(folder / "past.db") is None

    def _has(self, folder: Path, lost: Lost) -> None:
        with SqliteStore(folder / "past.db") as store:
            there = seconds_in(store.ledger("R") or {"newest": None})
        least = min((begin for begin, _ in lost), default=0)
        assert there >= least, f"the ledger ends at {there}, and {least} were kept"


class OfService(OfReplay):
    """The monitoring of a service, which plays a recording into its store."""

    name, length = "serve", 300

    def work(self, folder: Path, marks: Marks, begin: int, end: int) -> None:
        """Play it, as fast as it goes."""
        robophm.monitoring.live_loop.SAVE_EVERY = 0.005
        played(Monitored(folder / "past.db", marks), folder / "drive.csv")
        marks.say("heard", self.length)

    def judge(self, folder: Path, heard: int, lost: Lost) -> None:
        """Play it to its end: the ledger is as if it had been played once, without an end on the way."""
        if not self._undisturbed.robots():
            with tempfile.TemporaryDirectory() as apart:
                played(Monitoring(Path(apart) / "past.db"), folder / "drive.csv")
                with SqliteStore(Path(apart) / "past.db") as store:
                    self._undisturbed.save("R", store.ledger("R") or {})
        self._has(folder, lost)
        played(Monitoring(folder / "past.db"), folder / "drive.csv")
        with SqliteStore(folder / "past.db") as store:
            assert store.ledger("R") == self._undisturbed.ledger("R"), "the ledger is another"
        assert restore_store(folder / "past.db") is None


def subjects() -> list[Subject]:
    """All of them."""
    return [OfJournal(), OfStore(), OfWatch(), OfReplay(), OfService()]


class Said(SignalSource):
    """A robot that says samples, from one number until before another."""

    ends, fingerprint = False, "said"

    def __init__(self, marks: Marks, begin: int, end: int) -> None:
        self.marks, self.begin, self.end = marks, begin, end
        self.notes: Counter[str] = Counter()

    def topics(self) -> list[TopicInfo]:
        """None are known."""
        return []

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Say them; what was said before is in the journal, and handed over, once the clock was said."""
        for number in range(self.begin, self.end):
            if number and (number - self.begin) and (number % CLOCK_EVERY == 0):
                self.marks.say("flushed", number)
            self.marks.say("heard", number + 1)
            yield sample(number)


class Marking(SqliteStore):
    """A store that says after each save how far it is."""

    def __init__(self, path: Path, kept: Callable[[Mapping[str, Any]], None]) -> None:
        super().__init__(path)
        self._kept = kept

    def save(
        self, robot: str, ledger: Mapping[str, Any], progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (), events: Sequence[Event] = (),
        answers: Mapping[str, Mapping[str, Any]] = {},
    ) -> None:  # fmt: skip
        """Save, and say so."""
        super().save(robot, ledger, progress, reports, events, answers)
        self._kept(ledger)


class Monitored(Monitoring):
    """The monitoring of a service whose store says how far it is."""

    def __init__(self, path: Path, marks: Marks) -> None:
        super().__init__(path)
        self._path, self._marks = path, marks

    def _store_of(self, choice: Choice) -> Store:
        return Marking(self._path, lambda ledger: self._marks.say("kept", seconds_in(ledger)))


def played(monitoring: Monitoring, recording: Path) -> None:
    """Play a recording to its end, as fast as it goes."""
    monitoring.start(ROBOT, choices([recording], live=False)["recordings"], 1e6, 0)
    assert monitoring._thread
    monitoring._thread.join()
    assert monitoring.run
    assert not monitoring.run.error, monitoring.run.error


def seconds_in(ledger: Mapping[str, Any]) -> int:
    """How many seconds of samples are in a ledger."""
    newest = ledger["newest"]
    return 0 if newest is None else int(newest - BEGIN) // SECOND + 1


def save(store: SqliteStore, number: int) -> None:
    """Save a state of this number, an alarm and every fifth time a request before it."""
    if number % 5 == 0:
        store.service_requests("R").leave(ServiceRequest(f"{number}", {"part": "hot"}))
    alarm = {"what": "hot", "path": "hot", "begin": BEGIN + number, "end": None, "cause": "", "severity": "warn"}
    store.alarm_log("R").keep([{**alarm, "acknowledged_by": "", "acknowledged_at": None}])
    figures = {"hazard_rate": 1 / (1 + number), "unreliability": 0.5}
    robot = {"path": "R", "flags": [], "breaches": [], "nominal": figures, "sensor_based": figures}
    report = {"time": BEGIN + number, "state": "ok", "clocks": {"operating": number}, "subjects": [robot]}
    more = {"filler": ["x" * 40] * 50}
    event = Event(BEGIN + number, "restart", "", "again")
    store.save("R", {"saves": number + 1, **more}, [Progress("drive", number + 1)], [report], [event])


def journaled(path: Path) -> list[Sample]:
    """The samples in a journal."""
    recording = JournalRecording(path)
    return [*recording.samples(recording.signals)]


def is_told_once(there: Sequence[Sample], heard: int, lost: Lost) -> None:
    """Assert that samples are those that were heard, in order and once, but for those that may be lost."""
    numbers = [(one.time - BEGIN) // SECOND for one in there]
    assert [*map(repr, there)] == [repr(sample(number)) for number in numbers], "a sample is made up"
    assert numbers == sorted(set(numbers)), "a sample counts twice"
    missing = {*range(heard)}.difference(numbers)
    wrong = [number for number in missing if not any(begin <= number < end for begin, end in lost)]
    assert not wrong, f"lost: {sorted(wrong)[:9]}"
    assert not numbers or numbers[-1] < heard, "a sample is there that was not heard"
