"""A clock that lies while a robot is watched: the ledger is that of a clock that was right, but for what is named."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.errors import RobophmError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.report import HealthReport
from robophm.health.suspect_time import settle
from robophm.monitoring.live_loop import watch
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.transports.live.decoding import Numbers
from robophm.transports.live.machine_time import MachineTime
from robophm.transports.live.receiving import Receiver
from robophm.transports.recordings.journal import Journal, JournalRecording
from robophm.transports.signals.incidents import Incidents
from robophm.transports.signals.source import LiveItem, LiveSource, TopicInfo

from .designs import IN_2038, MEASURED, MOTOR, WARM, bound, robot
from .designs import MEASURED_AS as T

DAY = 24 * HOUR
BOOT = 1_795_000_000 * SECOND
LEAP = BOOT + 200 * SECOND
"""A midnight of UTC would be one; the kernel tells it by saying one second twice, wherever it is."""
NEVER = range(0)

Clock = Callable[[int], int]
"""What a machine's clock says at a true time [ns]."""


def right(now: int) -> int:
    return now


@pytest.fixture(scope="module")
def design() -> Robot:
    wears = {"life": {"distribution": "weibull", "scale": "40 h", "shape": 2.5}, "scaling": "hazard"}
    shelf = {"rate": "0.001 /h", "clock": "calendar"}
    return robot(**MEASURED, components={**MOTOR, "seal": {**wears, "acceleration": {"model": "q10"}}, "shelf": shelf})


class Machine(LiveSource):
    """A robot whose motor warms up, heard each second of true time by a machine with this clock."""

    def __init__(
        self, clock: Clock, begin: int, seconds: int, *,
        sleeps: range = NEVER, silent: range = NEVER, counted: bool = True,
    ) -> None:  # fmt: skip
        """``sleeps``: true times at which the machine does; ``counted``: its other clock goes on meanwhile.

        ``silent``: true times at which the robot says nothing.
        """
        self.notes = Counter()
        self.fingerprint = ""
        self.heard = 0
        self._clock, self._begin, self._seconds = clock, begin, seconds
        self._sleeps, self._silent, self._counted = sleeps, silent, counted

    def topics(self) -> list[TopicInfo]:
        return []

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        true = self._begin

        def note(words: str) -> None:
            self.notes[words] += 1

        def steady() -> int:
            slept = len(self._sleeps) if true >= self._sleeps.stop else 0
            return true - BOOT - (0 if self._counted else slept)

        machine = MachineTime(self.known_to, note, clock=lambda: self._clock(true), steady=steady)
        for true in range(self._begin, self._begin + self._seconds * SECOND, SECOND):
            if true in self._sleeps:
                continue
            if now := machine.now():
                if true not in self._silent:
                    self.heard += 1
                    yield Sample(now, T, 30.0 + true // SECOND % 400 / 10)
                yield Sample(now, CLOCK, machine.ahead)


class Life:
    """A robot that is watched from time to time, with its past in a store."""

    def __init__(self, design: Robot) -> None:
        self.design, self.store = design, MemoryStore()
        self.notes: list[str] = []
        self.heard = 0

    def lives(
        self, begin: int, seconds: int, clock: Clock = right, journal: Path | None = None, **options: Any
    ) -> Life:
        machine = Machine(clock, begin, seconds, **options)
        if journal:
            with Journal(journal, self.design.signals) as written:
                self.monitor = watch(self.design, machine, store=self.store, journal=written, period=20)
        else:
            self.monitor = watch(self.design, machine, store=self.store, period=20)
        self.notes += machine.notes
        self.heard += machine.heard
        return self

    @property
    def ledger(self) -> Ledger:
        return self.monitor.ledger

    @property
    def seconds(self) -> list[float]:
        """Operating and calendar time so far [s], up to the last sample."""
        return [float(hours) * 3600 for hours in self.monitor.exposure.settled(self.ledger).clocks.value[:2]]

    @property
    def report(self) -> HealthReport:
        return self.monitor.report(remaining_life=False)

    def but_for_the_named(self) -> dict[str, Any]:
        return {key: value for key, value in self.ledger.to_json().items() if key != "suspect_time"}


@pytest.fixture(scope="module")
def undisturbed(design: Robot) -> dict[str, Any]:
    """The ledger of a quarter of an hour by a clock that was right."""
    return Life(design).lives(BOOT, 900).ledger.to_json()


def stepped(at: int, by: int, until: int = 1 << 62) -> Clock:
    return lambda now: now + by if at <= now < until else now


def to_and_fro(now: int) -> int:
    """Right, two minutes ahead, three hours behind, 2038, and so on, by turns of seven seconds."""
    turn = (now - BOOT) // (7 * SECOND)
    return now + (0, 120 * SECOND, -3 * HOUR, IN_2038 - BOOT)[turn % 4]


JUMPS = {
    "2038 for 20 s": (stepped(BOOT + 200 * SECOND, IN_2038 - BOOT, BOOT + 220 * SECOND), 1),
    "1970 for 20 s": (stepped(BOOT + 200 * SECOND, -BOOT, BOOT + 220 * SECOND), 1),
    "an hour back": (stepped(BOOT + 200 * SECOND, -HOUR), 1),
    "an hour back for eleven minutes": (stepped(BOOT + 200 * SECOND, -HOUR, BOOT + 860 * SECOND), 1),
    "NTP, 2 s forward": (stepped(BOOT + 200 * SECOND, 2 * SECOND), 0),
    "NTP, 2 s back": (stepped(BOOT + 200 * SECOND, -2 * SECOND), 0),
    "NTP, 30 s forward": (stepped(BOOT + 200 * SECOND, 30 * SECOND), 0),
    "NTP, 30 s back": (stepped(BOOT + 200 * SECOND, -30 * SECOND), 0),
    "NTP, as fast as it slews": (lambda now: now + (now - BOOT) // 2000, 0),
    "a leap second": (stepped(LEAP, -SECOND), 0),
    "to and fro each 7 s": (to_and_fro, 96),
    "to and fro each second": (lambda now: to_and_fro(BOOT + 7 * (now - BOOT)), 100),
}
"""Clocks that lie from two hundred seconds after the boot on, and how many stretches of that are named."""


@pytest.mark.parametrize(("clock", "named"), JUMPS.values(), ids=JUMPS)
def test_the_ledger_is_that_of_a_clock_that_was_right(
    design: Robot, undisturbed: dict[str, Any], tmp_path: Path, clock: Clock, named: int
) -> None:
    """Bit for bit but for the stretches that are named, and so is that of the journal."""
    journal = tmp_path / "run.journal"
    life = Life(design).lives(BOOT, 900, clock, journal)
    assert life.but_for_the_named() == undisturbed
    stretches = life.ledger.suspect_time
    off = [now for now in range(BOOT, BOOT + 900 * SECOND, SECOND) if abs(clock(now) - now) >= 60 * SECOND]
    assert len(stretches) == named
    assert [any(one.begin <= now <= one.end for one in stretches) for now in off] == [True] * len(off)
    again = MemoryStore()
    replay(design, JournalRecording(journal), store=again, period=20.0)
    assert json.dumps(again.ledger("R")) == json.dumps(life.ledger.to_json())


@pytest.mark.full
def test_a_machine_that_sleeps_for_hours_and_wakes(design: Robot) -> None:
    """All that was heard counts, and the sleep as rest: a machine that hears nobody for as long has the same sums.

    Where the other clock does not count the sleep, time goes on without it until the clock is believed.
    """
    seconds, night = 7200 + 1500, range(BOOT + 300 * SECOND, BOOT + 300 * SECOND + 2 * HOUR)
    slept, silent = Life(design).lives(BOOT, seconds, sleeps=night), Life(design).lives(BOOT, seconds, silent=night)
    uncounted = Life(design).lives(BOOT, seconds, sleeps=night, counted=False)
    for life, off, totals in (
        (slept, 1e-12, ("clocks", "age", "effective", "hazard")),
        (uncounted, 1 / 3600, ("clocks", "age")),  # a minute until it is off is put elsewhere, at another temperature
    ):
        assert not life.ledger.counts
        assert life.heard == silent.heard
        assert life.ledger.newest == silent.ledger.newest
        for total in totals:
            assert getattr(life.ledger, total).value == pytest.approx(getattr(silent.ledger, total).value, abs=off)
    assert slept.notes == slept.ledger.suspect_time == []
    (stretch,) = uncounted.ledger.suspect_time
    assert stretch.outcome == "believed"
    assert stretch.end - stretch.begin == pytest.approx(600 * SECOND, abs=2 * SECOND)


@pytest.mark.parametrize("by", [30, -30])
def test_a_small_step_is_said(design: Robot, by: int) -> None:
    life = Life(design).lives(BOOT, 300, stepped(BOOT + 200 * SECOND, by * SECOND))
    assert life.notes == [f"the clock was set {'forward' if by > 0 else 'back'}; time went on as it was"]


@pytest.mark.full
@pytest.mark.parametrize("share", [1e-4, -1e-4], ids=["fast", "slow"])
def test_a_clock_that_drifts_is_off_by_its_drift_alone(design: Robot, share: float) -> None:
    """As bad a quartz as there is: nine seconds a day."""
    drifting = Life(design).lives(BOOT, 3601, lambda now: now + round(share * (now - BOOT)))
    right_all_along = Life(design).lives(BOOT, 3601)
    assert drifting.heard == right_all_along.heard
    assert drifting.notes == []
    for off, true in zip(drifting.seconds, right_all_along.seconds, strict=True):
        assert abs(off - true) <= abs(share) * 3600 + 0.001


@pytest.mark.parametrize("year", [1970, 2038])
def test_a_glitch_is_named(design: Robot, year: int) -> None:
    by = (IN_2038 if year == 2038 else 0) - BOOT
    life = Life(design).lives(BOOT, 300, stepped(BOOT + 200 * SECOND, by, BOOT + 220 * SECOND))
    (stretch,) = life.ledger.suspect_time
    assert stretch == (BOOT + 200 * SECOND, BOOT + 219 * SECOND, by / SECOND, "passed")
    hours = f"{abs(by) / HOUR:,.2f} h {'ahead' if by > 0 else 'behind'}"
    assert [note for note in life.report.notes if f"the clock was {hours}: time went on without it" in note]
    assert "clock not plausible" not in life.report.system.flags


def test_the_robot_is_marked_on_every_face_while_the_clock_is_off(design: Robot) -> None:
    life = Life(design).lives(BOOT, 900, stepped(BOOT + 200 * SECOND, -3 * HOUR))
    assert "clock not plausible" in life.report.system.marks
    assert life.report.state == "warn"
    told = life.report.to_json()
    begin, end = BOOT + 200 * SECOND, BOOT + 899 * SECOND
    assert told["suspect_time"] == [{"begin": begin, "end": end, "ahead": -10800.0, "outcome": ""}]


@pytest.mark.full
def test_a_clock_set_back_by_hours_makes_no_robot_deaf(design: Robot) -> None:
    """It goes on, also over a restart in those hours, and the next day all sums are those of a clock that was right."""
    off = stepped(BOOT + 200 * SECOND, -3 * HOUR, BOOT + DAY // 2)
    there, should = Life(design), Life(design)
    for begin, seconds in ((BOOT, 900), (BOOT + DAY, 300)):
        there.lives(begin, seconds, off)
        should.lives(begin, seconds)
    assert there.but_for_the_named() == should.ledger.to_json()
    assert [one.outcome for one in there.ledger.suspect_time] == ["passed"]
    meanwhile = Life(design).lives(BOOT, 900, off).lives(BOOT + 1000 * SECOND, 300, off)
    assert meanwhile.seconds[0] == pytest.approx(899 + 299, abs=1e-6)
    assert not meanwhile.ledger.counts


def test_1970_at_the_first_boot_until_the_time_is_known(design: Robot) -> None:
    """Nothing is known yet: what comes before the clock is set does not count, and is said."""
    life = Life(design).lives(BOOT, 900, stepped(BOOT, -BOOT, BOOT + 40 * SECOND))
    assert life.ledger.to_json() == Life(design).lives(BOOT + 40 * SECOND, 860).ledger.to_json()
    assert life.heard == 860
    assert life.seconds == pytest.approx([859, 859], rel=1e-9)
    assert life.notes == ["the clock is before 2025: nothing counts until it is set, for ten minutes at most"]


def test_1970_for_ever_counts_all_the_same(design: Robot) -> None:
    """A machine without battery and network, started each day."""
    life = Life(design)
    for day in range(3):
        life.lives(BOOT + day * DAY, 1800, lambda now, day=day: now - BOOT - day * DAY)
    assert life.heard == 1200 + 2 * 1800
    assert life.seconds[0] == pytest.approx(1199 + 2 * 1799, abs=1e-3)
    assert not life.ledger.counts


@pytest.mark.full
@pytest.mark.parametrize("wrong", [0, IN_2038], ids=["1970", "2038"])
def test_a_clock_that_is_wrong_at_a_boot_and_right_later(design: Robot, wrong: int) -> None:
    """The robot has a past: time goes on from it; the night counts as rest once the clock is believed."""
    morning = BOOT + DAY

    def clock(now: int) -> int:
        return now - morning + wrong if morning <= now < morning + 40 * SECOND else now

    there = Life(design).lives(BOOT, 900).lives(morning, 3000, clock)
    should = Life(design).lives(BOOT, 900).lives(morning, 3000)
    assert there.heard == should.heard
    assert there.ledger.newest == should.ledger.newest
    assert there.ledger.clocks.value == pytest.approx(should.ledger.clocks.value, abs=1 / 3600)
    assert there.ledger.age.value == pytest.approx(should.ledger.age.value, abs=1 / 3600)
    assert not there.ledger.counts
    assert there.ledger.suspect_time[-1].outcome == "believed"


def test_a_restart_with_a_clock_behind_goes_on_and_the_journal_says_the_same(design: Robot, tmp_path: Path) -> None:
    journal = tmp_path / "run.journal"
    behind = Life(design).lives(BOOT, 900, journal=journal)
    behind.lives(BOOT + 1000 * SECOND, 600, lambda now: now - 5 * HOUR, journal)
    assert behind.seconds[0] == pytest.approx(899 + 599, abs=1e-6)
    assert not behind.ledger.counts
    store = MemoryStore()
    replay(design, JournalRecording(journal), store=store, period=20.0)
    assert json.dumps(store.ledger("R")) == json.dumps(behind.ledger.to_json())


@pytest.mark.parametrize("verdict", ["taken in", "struck out"])
def test_a_rest_of_years_is_taken_in_or_struck_out(design: Robot, verdict: Any) -> None:
    """Whether the robot rested for two years, or the clock is wrong by as much, nobody but its owner knows."""
    away = 800 * DAY
    life = Life(design).lives(BOOT, 900).lives(BOOT + away, 900)
    assert life.seconds == pytest.approx([1798, 1798], abs=1e-3)
    ledger = Ledger.from_json(json.loads(json.dumps(life.ledger.to_json())), life.ledger.modes, ())
    done = settle(design, ledger, verdict)
    assert done.outcome == verdict
    assert ledger.newest == pytest.approx(BOOT + away + 899 * SECOND, abs=1000)
    calendar = (BOOT + away + 899 * SECOND - BOOT) / SECOND if verdict == "taken in" else 1798
    assert ledger.clocks.value[1] * 3600 == pytest.approx(calendar, abs=1e-3)
    assert ledger.clocks.value[0] * 3600 == pytest.approx(1798, abs=1e-3)
    life.store.save("R", ledger.to_json())
    life.lives(BOOT + away + 1000 * SECOND, 100)
    assert life.ledger.newest == BOOT + away + 1099 * SECOND
    assert life.seconds[1] == pytest.approx(calendar + 200, abs=1e-3)
    with pytest.raises(RobophmError, match="there is nothing to take in or strike out"):
        settle(design, life.ledger, verdict)


def test_a_past_that_began_in_2038_is_brought_to_the_time_that_is(design: Robot) -> None:
    """Sums stay; times that were not yet are those of now, and the robot goes on."""
    life = Life(design).lives(BOOT, 900, stepped(BOOT, IN_2038 - BOOT, BOOT + 300 * SECOND))
    sums = life.monitor.exposure.settled(life.ledger).age.value
    with pytest.raises(RobophmError, match="nothing can be taken in"):
        settle(design, life.ledger, "taken in")
    settle(design, life.ledger, "struck out")
    assert life.ledger.newest == BOOT + 899 * SECOND
    assert life.ledger.age.value == pytest.approx(sums, rel=1e-12)
    life.store.save("R", life.ledger.to_json())
    life.lives(BOOT + HOUR, 300)
    assert life.ledger.newest == BOOT + HOUR + 299 * SECOND
    assert life.seconds[1] == pytest.approx(3600 + 299, abs=1e-6)
    assert not life.ledger.counts
    assert math.isfinite(life.report.system.sensor_based.hazard_rate)


class TwoMachines(LiveSource):
    """The motor's topic stamped by another machine, whose clock is off by so much; the shelf's by this one."""

    def __init__(self, off: float) -> None:
        self.notes = Incidents()
        self.fingerprint = ""
        self._off = off

    def topics(self) -> list[TopicInfo]:
        return []

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        heard: list[LiveItem] = []
        hearing = Receiver(self.notes, heard.extend, (), simulated=False, known_to=self.known_to)
        now = BOOT
        hearing._machine = MachineTime(None, self.notes.add, clock=lambda: now, steady=lambda: now)
        for number in range(200):
            now = BOOT + number * SECOND // 10
            for topic, off in (("/motor", self._off), ("/shelf", 0.0)):
                hearing.messages(Stamped(topic, now + round(off * SECOND), 30.0 + number % 50), [b""], None)
            hearing.tell()
            yield from heard
            heard.clear()


class Stamped:
    """A decoder of a message with a temperature and a stamp."""

    def __init__(self, topic: str, stamp: int, value: float) -> None:
        self.topic, self._stamp, self._value = topic, stamp, value

    def read(self, raw: bytes, *, whole: bool) -> Numbers:
        return Numbers(self._stamp, None, [(f"{self.topic}.temperature", self._value)], [])


@pytest.fixture(scope="module")
def two_topics() -> Robot:
    shelf = {"rate": "0.001 /h", **bound("/shelf", "temperature", unit="degC", max_age="10 s"), **WARM}
    return robot(**MEASURED, components={**MOTOR, "shelf": shelf})


@pytest.fixture(scope="module")
def together(two_topics: Robot) -> dict[str, Any]:
    """The ledger of machines whose clocks agree."""
    return watch(two_topics, TwoMachines(0.0), period=0.1).ledger.to_json()


@pytest.mark.full
@pytest.mark.parametrize("off", [5.0, -5.0, 3600.0, -3600.0])
def test_two_machines_whose_clocks_are_apart(
    two_topics: Robot, together: dict[str, Any], off: float, tmp_path: Path
) -> None:
    """The ledger is that of clocks that agree, bit for bit; a stamp of 5 s ago is believed, which begins it earlier."""
    source = TwoMachines(off)
    with Journal(tmp_path / "run.journal", two_topics.signals) as journal:
        ledger = watch(two_topics, source, journal=journal, period=0.1).ledger
    assert not ledger.counts
    if off == -5:
        assert ledger.clocks.value * 3600 == pytest.approx(np.array(together["totals"]["clocks"][0]) * 3600 + 5)
    else:
        assert ledger.to_json() == together
    kept = Counter(sample.signal for sample in JournalRecording(tmp_path / "run.journal").samples(two_topics.signals))
    assert kept["/motor.temperature"] == kept["/shelf.temperature"] == 200
    told = [note for note in source.notes if "/motor" in note]
    assert told == [{
        -5.0: "too late for its own time, counted when it was heard: /motor.temperature"
    }.get(off, "receipt time used for /motor")]  # fmt: skip
    assert not any("/shelf" in note for note in source.notes)
