"""A disk that is full for a while ends no watch: it is said, and the past is kept once there is room again."""

from __future__ import annotations

import subprocess
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path

import pytest

from robophm.core.errors import StoreError
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.health.report import HealthReport
from robophm.monitoring import live_loop
from robophm.monitoring.live_loop import watch
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import NoRoomError
from robophm.transports.recordings.journal import Journal, JournalRecording
from robophm.transports.signals.report_sink import JudgedTask, ReportSink
from robophm.transports.signals.source import SignalSource, TopicInfo

from .designs import MEASURED, MOTOR, robot
from .designs import MEASURED_AS as T

START = 1_795_000_000 * SECOND
ROBOT = robot(**MEASURED, components=MOTOR)


class Filling(SignalSource):
    """Ten minutes of a motor, in the middle of which somebody else fills the disk, and then makes room."""

    def __init__(self, disk: Path | None, until: int = 400) -> None:
        self.fingerprint = ""
        self.notes = Counter()
        self._disk, self._until = disk, until

    def topics(self) -> list[TopicInfo]:
        return []

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        for second in range(600):
            if self._disk and second == 200:
                with (self._disk / "ballast").open("wb", buffering=0) as ballast:
                    while True:
                        try:
                            ballast.write(bytes(4096))
                        except OSError:
                            break
            if self._disk and second == self._until:
                (self._disk / "ballast").unlink()
            yield Sample(START + second * SECOND, T, 30.0 + second % 40)
            yield Sample(START + second * SECOND, CLOCK, float("nan"))


class Told(ReportSink):
    """What was said on the way."""

    def __init__(self) -> None:
        self.said: Counter[str] = Counter()

    def publish(self, report: HealthReport) -> None:
        pass

    def judged(self, task: JudgedTask) -> None:
        pass

    def noted(self, notes: Counter[str]) -> None:  # type: ignore[override]
        self.said |= notes


def test_a_disk_that_is_full_for_a_while(small_disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_loop, "SAVE_EVERY", 0.0)
    monkeypatch.setattr(live_loop, "NOTES_EVERY", 0.0)
    told, whole = Told(), MemoryStore()
    watch(ROBOT, Filling(None), store=whole, period=10.0)
    journal = small_disk / "run.journal"
    with SqliteStore(small_disk / "past.db") as store, Journal(journal, ROBOT.signals) as written:
        watch(ROBOT, Filling(small_disk), store=store, journal=written, period=10.0, sinks=[told])
    assert any("not saved, tried again" in note and "full" in note for note in told.said)
    assert any(note.endswith("run.journal: not written, No space left on device") for note in told.said)
    with SqliteStore(small_disk / "past.db") as store:
        assert store.ledger("R") == whole.ledger("R")
        assert len(list(store.history("R").reports())) == len(list(whole.history("R").reports()))
    recording = JournalRecording(journal)
    heard = [sample.time for sample in recording.samples([T]) if sample.signal == T]
    lost = {START + second * SECOND for second in range(600)} - {*heard}
    assert lost <= {START + second * SECOND for second in range(200, 401)}
    assert len(lost) > 50
    assert journal.read_text().count("# gap no room on the disk ") == 1


def test_a_disk_that_stays_full_is_loud_at_the_end(small_disk: Path) -> None:
    with SqliteStore(small_disk / "past.db") as store, pytest.raises(NoRoomError, match="full"):
        watch(ROBOT, Filling(small_disk, until=10_000), store=store, period=10.0)
    (small_disk / "ballast").unlink()
    with SqliteStore(small_disk / "past.db") as store:
        assert store.robots() == ["R"]


def test_a_past_that_nobody_may_write_is_read(small_disk: Path) -> None:
    with SqliteStore(small_disk / "past.db") as store:
        watch(ROBOT, Filling(None), store=store, period=10.0)
        known = store.ledger("R")
    subprocess.run(["mount", "-o", "remount,ro", str(small_disk)], check=True)
    with SqliteStore(small_disk / "past.db") as store:
        assert store.ledger("R") == known
        with pytest.raises(StoreError, match="readonly"):
            store.save("R", {"n": 1})
