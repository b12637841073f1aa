"""Services noted while a robot is watched: as if watching had ended there and begun again, whoever is killed."""

from __future__ import annotations

import json
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager, nullcontext
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import RobophmError, StoreError
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.design.file import parse
from robophm.health.ledger import Service
from robophm.health.report import HealthReport
from robophm.health.service import ServiceNote
from robophm.monitoring import live_loop
from robophm.monitoring.live_loop import watch
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import kept_ledger
from robophm.monitoring.service_notes import note_in, note_service, taken_in
from robophm.stores.memory import MemoryStore
from robophm.stores.service_requests import ServiceRequest, WithdrawnError
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import HeldError, NoRoomError
from robophm.transports.recordings.journal import Journal, JournalRecording
from robophm.transports.signals.report_sink import JudgedTask, ReportSink
from robophm.transports.signals.source import SignalSource, TopicInfo

from .designs import MEASURED, MOTOR, written
from .designs import MEASURED_AS as T

START = 1_795_000_000 * SECOND
GEAR = {"rate": "0.02 /h", "life": {"distribution": "weibull", "shape": 2}, "scaling": "hazard"}
DESIGN = written(**MEASURED, components=MOTOR, modules={"drive": {"components": {"gear": {**MOTOR["motor"], **GEAR}}}})
ROBOT = parse(DESIGN)
MODES = {mode.key: mode.path for mode in ROBOT.modes}
STEP = SECOND // 5
SHARE = 0.25


class Running(SignalSource):
    """A robot that goes on, at fifty times its pace, from a time until it is told to end."""

    def __init__(
        self, start: int = START, between: Callable[[int], None] = lambda step: None, steps: int = 10**9
    ) -> None:
        self.fingerprint = ""
        self.notes = Counter()
        self._start, self._between, self._steps = start, between, steps
        self.over = False

    def topics(self) -> list[TopicInfo]:
        return []

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        for step in range(self._steps):
            if self.over:
                return
            at = self._start + step * STEP
            yield Sample(at, T, 30.0 + at // STEP % 61 / 7)
            yield Sample(at, CLOCK, float("nan"))
            self._between(step)


class Reports(ReportSink):
    def __init__(self) -> None:
        self.all: list[HealthReport] = []

    def publish(self, report: HealthReport) -> None:
        self.all.append(report)

    def judged(self, task: JudgedTask) -> None:
        pass


def serviced(samples: Sequence[Sample], services: Sequence[Service]) -> dict[str, Any]:
    """The ledger of a robot that was stopped, served and started anew at these times; one request each."""
    store, left = MemoryStore(), [*services]
    monitor = Monitor(ROBOT, period=1.0)

    def stopped() -> Monitor:
        store.save(ROBOT.identity, monitor.ledger.to_json())
        while left and left[0].time == (monitor.ledger.integrated_to or 0):
            one = left.pop(0)
            share = None if one.kind == "replaced" else SHARE
            note_in(store, ROBOT, ServiceNote(MODES[one.mode], share, one.failed, one.by, one.note))
        return Monitor(ROBOT, kept_ledger(ROBOT, store), period=1.0)

    for sample in samples:
        monitor.observe(sample)
        if left and left[0].time <= (monitor.ledger.integrated_to or 0):
            monitor = stopped()
    assert not left
    return monitor.ledger.to_json()


def heard(journal: Path) -> list[Sample]:
    return list(JournalRecording(journal).samples([T]))


def same(found: Any, expected: Any) -> None:
    assert json.dumps(found) == json.dumps(expected)


@pytest.mark.parametrize("kind", [MemoryStore, SqliteStore])
def test_a_service_while_watched_is_one_between_two_runs(kind, tmp_path, monkeypatch):
    """It is asked for by another thread, with a connection of its own where the store is a file."""
    monkeypatch.setattr(live_loop, "NOTES_EVERY", 0.0)
    robot, path, done, reports = ROBOT, tmp_path / "past.db", [], Reports()
    asked = [
        ServiceNote("motor", None, failed=True, by="Ada", note="bearing noise"), ServiceNote("drive/gear", SHARE),
        ServiceNote("drive/gear", None),
    ]  # fmt: skip
    pool = ThreadPoolExecutor(1)
    with kind(path) as store:
        store.save(robot.identity, Monitor(robot).ledger.to_json())

        def ask(one: ServiceNote) -> list[Service]:
            with nullcontext(store) if kind is MemoryStore else SqliteStore(path) as own:
                return note_in(own, robot, one, wait=60)

        def between(step: int) -> None:
            if step % 40 == 25 and asked:
                coming = pool.submit(ask, asked.pop(0))
                while not (waiting := store.service_requests(robot.identity).waiting()) and not coming.done():
                    time.sleep(0.001)
                assert waiting
                done.append(coming)

        source = Running(between=between, steps=200)
        with Journal(tmp_path / "run.journal", robot.signals) as journal:
            watch(robot, source, store=store, journal=journal, period=1.0, sinks=[reports])
        services = [service for coming in done for service in coming.result(60)]
        ledger = store.ledger(robot.identity)
        assert [(MODES[one.mode], one.kind, one.by) for one in services] == [
            ("motor", "replaced", "Ada"), ("drive/gear", "repaired", ""), ("drive/gear", "replaced", "")
        ]  # fmt: skip
        told = {event.kind: event.said for event in store.history(robot.identity).events()}
        assert told["replacement"] == "drive/gear replaced"
    same(ledger, serviced(heard(tmp_path / "run.journal"), services))
    failed = [(report.time, failing(report, "drive")) for report in reports.all]
    falls = [time for (_, before), (time, now) in pairwise(failed) if now < before]
    # The next report, one period later, knows of all up to the newest sample: integration trails that by a second.
    assert [time - one.time for time, one in zip(falls, services[1:], strict=True)] == [2 * SECOND] * 2


def failing(report: HealthReport, path: str) -> float:
    """The probability that it has failed since it was new, which falls in no other way."""
    return next(one.sensor_based.unreliability for one in report.subjects if one.path == path)


ZYGOTE = """
import os, sys, time
sys.path.insert(0, sys.argv[1])
from pathlib import Path
from tests.monitoring import test_service_notes as t
for line in sys.stdin:
    pid = os.fork()
    if not pid:
        t.run(Path(line.strip()))
        os._exit(0)
    print(pid, flush=True)
    os.waitpid(pid, 0)
    print("over", flush=True)
"""


@pytest.fixture
def held(tmp_path: Path) -> Iterator[SqliteStore]:
    """The store of a robot that somebody watches, who takes nothing in."""
    with SqliteStore(tmp_path / "past.db") as store, store.alone(ROBOT.identity):
        store.save(ROBOT.identity, Monitor(ROBOT).ledger.to_json())
        yield store


def test_what_nobody_answers_is_withdrawn(held: SqliteStore) -> None:
    words = r"nobody answered within 0.1 s, and nothing was noted: .*past.db: process \d+ goes on with the past of R"
    with pytest.raises(HeldError, match=words):
        note_service(held.path, ROBOT, ServiceNote("motor"), wait=0.1)
    assert held.service_requests(ROBOT.identity).waiting() == []


def test_what_was_withdrawn_meanwhile_is_not_done(held: SqliteStore) -> None:
    """Who held the past had read the request, and taken it into a copy of the ledger, when it was withdrawn."""
    requests = held.service_requests(ROBOT.identity)
    requests.leave(ServiceRequest("a", ServiceNote("motor").to_json()))
    ledger, answers = taken_in(ROBOT, kept_ledger(ROBOT, held), requests.waiting())
    assert ledger.services
    assert answers
    assert requests.withdraw("a")
    with pytest.raises(WithdrawnError):
        held.save(ROBOT.identity, ledger.to_json(), answers=answers)
    assert kept_ledger(ROBOT, held).services == []


def test_requests_are_taken_in_order_and_once_and_refused_in_words(held: SqliteStore) -> None:
    """Whoever holds the past may have another design than who asks: it decides."""
    requests = held.service_requests(ROBOT.identity)
    asked = [ServiceNote("motor"), ServiceNote("motr"), ServiceNote("drive/gear", 0.5), ServiceNote("motor", 0.0)]
    for i, one in enumerate(asked):
        requests.leave(ServiceRequest(str(i), one.to_json()))
    requests.leave(ServiceRequest("0", ServiceNote("drive/gear").to_json()))  # as it is known it changes nothing
    requests.leave(ServiceRequest("other", {"part": "motor", "of a later version": 1}))
    before = kept_ledger(ROBOT, held)
    ledger, answers = taken_in(ROBOT, before, requests.waiting())
    assert before.services == []
    held.save(ROBOT.identity, ledger.to_json(), answers=answers)
    assert [MODES[one.mode] for one in kept_ledger(ROBOT, held).services] == ["motor", "drive/gear", "motor"]
    assert requests.answer("1") == {"refused": "no part 'motr'; did you mean 'motor'?"}
    assert "refused" in requests.answer("other")
    assert requests.waiting() == []
    assert not requests.withdraw("0")
    with pytest.raises(RobophmError, match="no part 'motr'; did you mean 'motor'"):
        note_service(held.path, ROBOT, ServiceNote("motr"))


def test_a_request_that_is_not_as_it_was_left_is_never_done(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_loop, "NOTES_EVERY", 0.0)
    with SqliteStore(tmp_path / "past.db") as store:
        requests = store.service_requests(ROBOT.identity)
        requests.leave(ServiceRequest("a", ServiceNote("motor", 0.5).to_json()))
        with closing(sqlite3.connect(store.path)) as base, base:
            base.execute("UPDATE service_request SET asked = replace(asked, '0.5', '0.7')")
        with pytest.raises(StoreError, match="the service_request a of R is damaged: its checksum is another"):
            requests.waiting()
        source = Running(steps=20)
        watch(ROBOT, source, store=store)  # which goes on without it, and says so
    assert any(one.startswith("services that are asked for cannot be read: ") for one in source.notes)


def test_where_there_is_no_room_it_is_noted_once_there_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The ledger of the run does not know of it before it is kept."""
    monkeypatch.setattr(live_loop, "NOTES_EVERY", 0.0)
    full, seen = [3], []

    class Full(MemoryStore):
        def save(self, *given: Any, **more: Any) -> None:
            if more and full[0]:
                full[0] -= 1
                raise NoRoomError("database or disk is full")
            super().save(*given, **more)

    with Full() as store:
        store.service_requests(ROBOT.identity).leave(ServiceRequest("a", ServiceNote("motor").to_json()))
        tick = lambda monitor: seen.append((full[0], len(monitor.ledger.services)))  # noqa: E731
        watch(ROBOT, Running(steps=60), store=store, period=1.0, on_tick=tick)
        assert {services for left, services in seen if left} <= {0}
        assert seen[-1] == (0, 1)
        assert len(kept_ledger(ROBOT, store).services) == 1


def test_words_are_one_line_and_bounded() -> None:
    with pytest.raises(RobophmError, match=r"note .*: expected one line of at most 1000 characters"):
        ServiceNote("motor", note="a\nb")
    with pytest.raises(RobophmError, match=r"by .*: expected one line of at most 100 characters"):
        ServiceNote("motor", by="x" * 101)
    with pytest.raises(RobophmError, match=r"remains 1.5: expected a number of at least 0 and at most 1"):
        ServiceNote("motor", 1.5)


def run(folder: Path) -> None:
    """Watch in a process of its own, from where the journal ends; whoever kills it has time to, around each save."""
    live_loop.NOTES_EVERY, live_loop.SAVE_EVERY = 0.002, 0.05  # type: ignore[misc]
    save = SqliteStore.save

    def slowly(self: SqliteStore, *given: Any, **more: Any) -> None:
        time.sleep(0.003 * bool(more))
        save(self, *given, **more)
        time.sleep(0.003 * bool(more))

    SqliteStore.save = slowly  # type: ignore[method-assign]
    journal = folder / "run.journal"
    before = max((sample.time for sample in heard(journal)), default=START) if journal.exists() else START
    with SqliteStore(folder / "past.db") as store, Journal(journal, ROBOT.signals) as written_to:
        source = Running(before + STEP, lambda step: time.sleep(0.001))
        signal.signal(signal.SIGTERM, lambda *_: setattr(source, "over", True))
        watch(ROBOT, source, store=store, journal=written_to, period=1.0)


@contextmanager
def zygote() -> Iterator[subprocess.Popen[str]]:
    words = [sys.executable, "-c", ZYGOTE, str(Path(__file__).parents[2])]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        try:
            yield child
        except BaseException:
            child.kill()
            raise
        assert child.stdin
        child.stdin.close()


@pytest.mark.full
def test_whoever_is_killed_a_service_is_noted_once(tmp_path: Path) -> None:
    kills, chance = 20, random.Random(20)
    path, journal = tmp_path / "past.db", tmp_path / "run.journal"
    with SqliteStore(path) as store:
        store.save(ROBOT.identity, Monitor(ROBOT).ledger.to_json())
    asked = {
        f"request {i}": ServiceNote("motor" if i % 2 else "drive/gear", None, by=f"person {i}") for i in range(kills)
    }
    with zygote() as parent, ThreadPoolExecutor(kills) as pool, SqliteStore(path) as looking:
        assert parent.stdin
        assert parent.stdout
        coming = []
        requests = looking.service_requests(ROBOT.identity)
        for key, note in [*asked.items(), ("", None)]:
            written = max((sample.time for sample in heard(journal)), default=START) if journal.exists() else START
            parent.stdin.write(f"{tmp_path}\n")
            parent.stdin.flush()
            pid = int(parent.stdout.readline())
            if note is None:
                for one in coming:
                    one.result(60)
                until = time.monotonic() + 60
                while looking.ledger(ROBOT.identity)["newest"] <= written:  # it takes in what the journal has first
                    assert time.monotonic() < until
                os.kill(pid, signal.SIGTERM)
            else:
                coming.append(pool.submit(note_service, path, ROBOT, note, key=key, wait=60))
                while not (coming[-1].done() or requests.answer(key) or key in [one.key for one in requests.waiting()]):
                    time.sleep(0.001)
                time.sleep(chance.uniform(0, 0.05))
                os.kill(pid, signal.SIGKILL)
            assert parent.stdout.readline() == "over\n"
        again = note_service(path, ROBOT, asked["request 0"], key="request 0")
        ledger = looking.ledger(ROBOT.identity)
        services = kept_ledger(ROBOT, looking).services
    assert sorted(one.by for one in services) == sorted(one.by for one in asked.values())
    assert again == [one for one in services if one.by == "person 0"]
    assert [one for coming_one in coming for one in coming_one.result()] == sorted(
        services, key=lambda one: int(one.by.split()[1])
    )
    same(ledger, serviced(heard(journal), services))
