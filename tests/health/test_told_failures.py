"""Failures that software tells of: counted by a plain loop over the same signals, and what a person strikes out."""

from __future__ import annotations

import json
import random
from itertools import pairwise

import numpy as np
import pytest

from robophm.core.errors import DesignError, RobophmError
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health import told_failures
from robophm.health.ledger import Ledger
from robophm.health.service import ServiceNote, failures, service_intervals, take_note
from robophm.learning.rates.rate_update import learn
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.rate_history import rate_history
from robophm.stores.events import events_of
from robophm.transports.signals.source import SignalColumns

HEAD = "schema_version: 1\nname: R\npowered: {topic: /on, field: data}\n"
ROBOT = parse(
    HEAD + "components:\n"
    "  lidar: {rate: 0.01 /h, initial_exposure: 5 h, failed_when: [{log: /lidar}, {lifecycle: /lidar}]}\n"
    "  camera:\n"
    "    rate: 0.02 /start\n"
    "    failed_when: [{topic: /camera, field: state, values: [2, 4], works: [0]}]\n"
    "    clock: starts\n"
    "    clocks: {starts: {topic: /lidar/transition_event, edge: goal_state.id, becomes: 3}}\n"
    "usage: {starts: 0.1 start/h}\n"
)
LOG, LIFECYCLE, CAMERA = "/rosout.level[/lidar]", "/lidar/transition_event.goal_state.id", "/camera.state"
START = 1_700_000_000 * SECOND
ERROR, ERROR_1, FATAL, WARN = 40.0, 8.0, 50.0, 30.0
ERROR_PROCESSING, ACTIVE, FINALIZED = 15.0, 3.0, 4.0


def ticks(hours: int) -> list[Sample]:
    return [Sample(START + 30 * n * SECOND, "/on.data", 1.0) for n in range(120 * hours + 1)]


def at(seconds: float, signal: str, value: float) -> Sample:
    return Sample(START + round(seconds * SECOND), signal, value)


def lived(samples: list[Sample], robot: Robot = ROBOT, period: float = 60.0) -> Ledger:
    monitor = Monitor(robot, period=period)
    for one in sorted(samples):
        monitor.observe(one)
    monitor.end(max(one.time for one in samples))
    return monitor.exposure.settled(monitor.ledger)


def seen(ledger: Ledger, path: str) -> tuple[int, float]:
    """Failures of a mode and the hours in which it worked, as they are learned from."""
    of = [one for one in service_intervals(ROBOT, ledger) if one.mode.path == path]
    return sum(one.failed for one in of), sum(one.hours for one in of)


def by_hand(samples: list[Sample], until: float) -> tuple[int, float]:
    """Failures of the lidar and the hours in which it worked: a state that goes to and fro, in seconds."""
    count, since, up = 0, 0.0, 0.0
    for one in sorted(samples):
        seconds = (one.time - START) / SECOND
        fails = (one.signal == LOG and one.value in (8, 16, 40, 50)) or (one.signal == LIFECYCLE and one.value == 15)
        if fails and since is not None:
            count, up, since = count + 1, up + seconds - since, None
        elif one.signal == LIFECYCLE and one.value == 3 and since is None:
            since = seconds
    return count, (up + (until - since if since is not None else 0)) / 3600


def drawn(seed: int, hours: int = 3) -> list[Sample]:
    """Bursts of messages, most of no consequence, and a lifecycle, each at a time of its own."""
    lot = random.Random(seed)
    found = []
    for second in sorted(lot.sample(range(1, 3600 * hours), 12)):
        kind = lot.choice(["burst", "quiet", "restart", "error"])
        if kind == "burst":
            found += [at(second + 0.01 * n, LOG, ERROR) for n in range(lot.randint(1, 40))]
        elif kind == "quiet":
            found += [at(second, LOG, lot.choice([0.0, 10.0, 20.0, WARN, 4.0])), at(second, LIFECYCLE, FINALIZED)]
        elif kind == "error":
            found.append(at(second, LIFECYCLE, ERROR_PROCESSING))
        else:
            found += [at(second + 0.1 * n, LIFECYCLE, state) for n, state in enumerate((10, 2, 13, ACTIVE))]
    return found


@pytest.mark.parametrize("seed", range(8))
def test_as_many_failures_and_hours_as_a_plain_count(seed: int) -> None:
    events = drawn(seed)
    ledger = lived(ticks(3) + events)
    count, hours = by_hand(events, 3 * 3600)
    assert seen(ledger, "lidar") == (count, pytest.approx(hours, rel=1e-12))
    assert len(failures(ledger)) == count
    assert ("lidar (operating, age scaling)" in ledger.failed) == (by_hand(events, 1e9)[1] < 1e4)


@pytest.mark.parametrize("seed", range(3))
def test_blocks_of_any_size_and_a_restart_give_the_same_ledger_bit_for_bit(seed: int) -> None:
    samples = sorted(ticks(3) + drawn(seed))
    whole, parted, blocks = Monitor(ROBOT, period=60.0), Monitor(ROBOT, period=60.0), Monitor(ROBOT, period=60.0)
    for one in samples:
        whole.observe(one)
    half = random.Random(seed).randrange(len(samples))
    for one in samples[:half]:
        parted.observe(one)
    parted = Monitor(ROBOT, Ledger.of(ROBOT, json.loads(json.dumps(parted.ledger.to_json()))), period=60.0)
    for one in samples[half:]:
        parted.observe(one)
    life = BlockMonitor(blocks)
    edges = sorted({0, len(samples), *random.Random(seed).sample(range(len(samples)), 5)})
    for begin, end in pairwise(edges):
        some: dict[str, list[Sample]] = {}
        for one in samples[begin:end]:
            some.setdefault(one.signal, []).append(one)
        times = {signal: np.array([one.time for one in of]) for signal, of in some.items()}
        life.observe({
            signal: SignalColumns(times[signal], times[signal], np.array([one.value for one in of]))
            for signal, of in some.items()
        })  # fmt: skip
        life._go_on()
    life.finish()
    assert parted.ledger.to_json() == blocks.ledger.to_json() == whole.ledger.to_json()


def test_what_is_learned_is_the_count_over_the_hours() -> None:
    """With a prior that counts as nothing the rate is failures over exposure: three bursts, and two times of repair."""
    events = [at(3600 * hour + 0.1 * n, LOG, ERROR_1) for hour in (10, 20, 30) for n in range(50)]
    events += [at(3600 * hour, LIFECYCLE, ACTIVE) for hour in (12, 22)]
    ledger = lived(ticks(40) + events, period=3600.0)
    history = rate_history(ROBOT, ledger, "R")
    (one,) = (one for one in learn(ROBOT, history, "1e-9 failures") if one.mode.path == "lidar")
    assert one.posterior.failures == 3
    assert one.factor * 0.01 == pytest.approx(3 / (10 + 8 + 8), rel=1e-6)


def test_a_failure_waits_for_a_person_where_nothing_says_that_it_works_again() -> None:
    robot = parse(HEAD + "components: {lidar: {rate: 0.01 /h, failed_when: [{log: lidar, level: fatal}]}}")
    monitor = Monitor(robot)
    for one in sorted([*ticks(1), at(60, LOG, ERROR), at(600, LOG, FATAL), at(900, LOG, FATAL)]):
        monitor.observe(one)
    (told,) = monitor.ledger.services
    assert (told.time, told.kind, told.by, told.note) == (
        START + 600 * SECOND, "failed", "software", "fatal of lidar on /rosout")  # fmt: skip
    report = monitor.report(remaining_life=False)
    assert "has failed: lidar" in report.subjects[0].flags
    take_note(robot, monitor.ledger, ServiceNote("lidar", by="Ann"))
    for one in [at(4000, "/on.data", 1), at(4000, LOG, FATAL), at(4200, "/on.data", 1)]:
        monitor.observe(one)
    assert [one.kind for one in monitor.ledger.services] == ["failed", "replaced", "failed"]
    assert [one.by for one in monitor.ledger.services] == ["software", "Ann", "software"]


def test_any_signal_tells_by_its_values_and_each_time_a_node_becomes_active_is_a_start() -> None:
    states = [(0, 0), (100, 1), (200, 2), (250, 4), (300, 1), (400, 0), (500, 4), (600, 0)]
    active = [(1 + 100 * n + 0.1 * k, state) for n in range(7) for k, state in enumerate((2, 13, 3, 3, 14, 2))]
    ledger = lived([*ticks(1), *(at(t, CAMERA, v) for t, v in states), *(at(t, LIFECYCLE, v) for t, v in active)])
    assert [(one.time - START) // SECOND for one in failures(ledger)] == [200, 500]
    # starts at 1, 101 … 601 s; those at 201, 301 and 501 s come between a failure and its end
    assert seen(ledger, "camera") == (2, pytest.approx(7 - 3))


def test_struck_out_is_as_if_it_had_never_been_told() -> None:
    """Exposure and failures are those of a run without the message; who said what, and when, stays known."""
    events = [at(1000, LIFECYCLE, ERROR_PROCESSING), at(2000, LIFECYCLE, ACTIVE), at(3000, LIFECYCLE, ERROR_PROCESSING)]
    robot, plain = ROBOT, lived([*ticks(1), *(one._replace(value=2.0) for one in events)])
    told = lived([*ticks(1), *events])
    assert seen(told, "lidar") == (2, pytest.approx(2000 / 3600))
    (last,) = take_note(robot, told, ServiceNote("lidar", by="Ann", note="a cable test", none=True))
    assert (last.kind, last.failed, last.time) == ("struck out", False, START + 3000 * SECOND)
    assert seen(told, "lidar") == (1, pytest.approx(2600 / 3600))
    take_note(robot, told, ServiceNote("lidar", by="Ann", none=True))
    assert seen(told, "lidar") == (0, pytest.approx(1, rel=1e-12))
    assert told.age.value[0] == pytest.approx(plain.age.value[0], rel=1e-12)
    active = told.seen["lidar (operating, age scaling)"]  # known to work once it was active again, at the age of then
    assert (active.time, active.age) == (START + 2000 * SECOND, pytest.approx(2000 / 3600))
    assert (told.failed, told.replaced, failures(told)) == (frozenset(), {}, [])
    kept = Ledger.of(robot, json.loads(json.dumps(told.to_json())))
    assert kept.to_json() == told.to_json()
    said = [(one.kind, one.said) for one in events_of(kept.to_json())]
    by_software = "told by software: lifecycle of /lidar"
    assert said == [
        ("failure struck out", f"lidar had not failed, struck out by Ann: {by_software}"),
        ("failure struck out", f"lidar had not failed, struck out by Ann: a cable test; {by_software}"),
    ]
    with pytest.raises(RobophmError, match="no failure of it was told of"):
        take_note(robot, told, ServiceNote("lidar", none=True))


def test_what_a_person_has_served_since_is_not_struck_out() -> None:
    ledger = lived([*ticks(1), at(100, LOG, ERROR)])
    take_note(ROBOT, ledger, ServiceNote("lidar"))
    with pytest.raises(RobophmError, match="'lidar' was replaced since it failed"):
        take_note(ROBOT, ledger, ServiceNote("lidar", none=True))


def test_modes_of_unknown_rate_and_beside_others_fail_and_are_learned_of() -> None:
    """A part fails by one of its modes alone: while it is down the other tells nothing new."""
    robot = parse(
        HEAD + "components:\n"
        "  Power: {rate: unknown, failed_when: [{log: /power}]}\n"
        "  arm:\n    identity: an arm\n    failure_modes:\n"
        "      gear: {rate: 0.01 /h, failed_when: [{topic: /arm, field: state, values: [1], works: [0]}]}\n"
        "      motor: {rate: 0.01 /h, failed_when: [{topic: /arm, field: state, values: [2], works: [0]}]}\n"
    )
    states = [(100, 1), (200, 2), (300, 0), (400, 2), (500, 1), (600, 0)]
    ledger = lived(
        [*ticks(1), at(50, "/rosout.level[/power]", ERROR), *(at(t, "/arm.state", v) for t, v in states)], robot
    )
    paths = {mode.key: mode.path for mode in robot.modes}
    assert [(paths[one.mode], one.kind) for one in ledger.services] == [
        ("Power", "failed"), ("arm/gear", "failed"), ("arm/gear", "repaired"), ("arm/motor", "failed"),
        ("arm/motor", "repaired"),
    ]  # fmt: skip
    failed = {one.mode.path: one.failures for one in rate_history(robot, ledger, "R")}
    assert failed == {"Power": 1, "arm/gear": 1, "arm/motor": 1}


def test_flapping_is_bounded_and_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(told_failures, "MOST_TOLD", 10)
    flaps = [at(n, LIFECYCLE, ERROR_PROCESSING if n % 2 else ACTIVE) for n in range(1, 3000)]
    ledger = lived([*ticks(1), *flaps])
    assert len(ledger.services) == 10
    assert ledger.counts[f"more than 10 failures and returns to work told: {LIFECYCLE}"] == 1


SILENT = parse(
    HEAD + "components: {lidar: {rate: 0.01 /h, failed_when: [{topic: /scan, field: range, silent: 10 s}]}}\n"
    "max_gap: 60 s"
)


def scans(*spans: tuple[int, int], every: float = 1.0) -> list[Sample]:
    return [
        at(begin + n * every, "/scan.range", 1.0) for begin, end in spans for n in range(round((end - begin) / every))
    ]


def powered(*spans: tuple[int, int], on: float = 1.0) -> list[Sample]:
    return [at(second, "/on.data", on) for begin, end in spans for second in range(begin, end, 2)]


@pytest.mark.parametrize(
    ("samples", "failed", "works"),
    [
        (powered((0, 600)) + scans((0, 100), (109, 300), (400, 600)), [309], [400]),  # the last at 99 and 299 s
        (powered((0, 600)) + scans((0, 100)), [109], []),
        (powered((0, 100), (300, 600)) + scans((0, 100), (300, 600)), [], []),  # the robot itself was silent
        (powered((0, 102), (300, 600)) + scans((0, 100), (300, 600)), [], []),  # it was heard a little longer
        (powered((0, 600)), [], []),  # it was never heard
        (powered((0, 100)) + powered((100, 300), on=0.0) + powered((300, 600)) + scans((0, 100), (300, 600)), [], []),
    ],
)
def test_silence_while_the_robot_is_heard(samples: list[Sample], failed: list[int], works: list[int]) -> None:
    for period in (0.7, 7.0, 60.0):
        ledger = lived(samples, SILENT, period)
        said = [((one.time - START) // SECOND, one.kind) for one in ledger.services]
        assert said == sorted([(time, "failed") for time in failed] + [(time, "repaired") for time in works])


def test_a_night_ends_no_failure_that_others_told_of() -> None:
    """An error of the log at 50 s; the scan is heard again after the robot was off, as it was until then."""
    robot = parse(
        HEAD + "components: {lidar: {rate: 0.01 /h, failed_when: [{log: /lidar}, "
        "{topic: /scan, field: range, silent: 10 s}]}}\nmax_gap: 60 s"
    )
    drive = [*powered((0, 100)), *powered((100, 300), on=0.0), *powered((300, 400)), *scans((0, 100), (300, 400))]
    ledger = lived([*drive, at(50, LOG, ERROR)], robot)
    assert [((one.time - START) // SECOND, one.kind) for one in ledger.services] == [(50, "failed")]
    assert len(ledger.failed) == 1


def test_silence_is_told_alike_in_blocks_and_after_restarts() -> None:
    lot = random.Random(3)
    spans, second = [], 0
    while second < 3600:
        length, pause = lot.randint(5, 400), lot.choice([3, 9, 11, 30, 200])
        spans.append((second, second + length))
        second += length + pause
    samples = sorted(powered((0, 3700)) + scans(*spans))
    pauses = [(end - 1, begin) for (_, end), (begin, _) in pairwise(spans)]
    whole, parted = Monitor(SILENT, period=13.0), Monitor(SILENT, period=13.0)
    for n, one in enumerate(samples):
        whole.observe(one)
        parted.observe(one)
        if n % 97 == 0:
            parted = Monitor(SILENT, Ledger.of(SILENT, json.loads(json.dumps(parted.ledger.to_json()))), period=13.0)
    assert parted.ledger.to_json() == whole.ledger.to_json()
    settled = whole.exposure.settled(whole.ledger)
    long = [(last, again) for last, again in pauses if again - last > 10]
    assert len(long) > 3
    assert [(one.time - START) // SECOND for one in failures(settled)] == [last + 10 for last, _ in long]
    (seen_,) = rate_history(SILENT, settled, "R")
    down = sum(again - last - 10 for last, again in long)
    assert seen_.exposure == pytest.approx(((samples[-1].time - START) / SECOND - down) / 3600, rel=1e-9)


@pytest.mark.parametrize(
    ("said", "why"),
    [
        ("failed_when: [{log: /a, lifecycle: /a}]", "exactly one of log, lifecycle, topic"),
        ("failed_when: [{lifecycle: /a, words: x}]", "expected log: NODE"),
        ("failed_when: [{topic: /a}]", "expected field, and values or silent"),
        ("failed_when: [{topic: /a, field: b, values: [1], silent: 3 s}]", "expected field, and values or silent"),
        ("failed_when: [{topic: /a, field: b, works: [1], silent: 3 s}]", "expected no works"),
        ("failed_when: [{topic: /a, field: b, silent: 0.1 s}]", "too small"),
        ("failed_when: [{topic: /a, field: b, values: [1], works: [1]}]", "expected one of both"),
        ("failed_when: [{log: 'no node'}]", "failed_when"),
        ("failed_when: [{log: /a, level: warn}]", "error"),
        ("failed_when: []", "failed_when"),
        ("failed_when: [{log: /a, words: 'no\u200bdata'}]", "expected one line"),
        (f"failed_when: [{{topic: /{'a' * 1000}, field: b, values: [1]}}]", "expected one line"),
        ("quantity: 2, failed_when: [{log: /a}]", "which of 2 is not said"),
        ("wear: {topic: /w, field: x, threshold: 3}, failed_when: [{lifecycle: /a}]", "in failure modes of their own"),
        ("failed_when: [{lgo: /a}]", "log"),
    ],
)
def test_what_contradicts_itself_is_refused(said: str, why: str) -> None:
    with pytest.raises(DesignError, match=why):
        parse(HEAD + f"components: {{a: {{rate: 0.01 /h, {said}}}}}")


def test_becomes_is_in_place_of_a_threshold() -> None:
    clock = "clock: starts, clocks: {starts: {topic: /a, edge: b, becomes: 3, threshold: 2}}"
    with pytest.raises(DesignError, match="becomes is of an edge, in place of its threshold"):
        parse(HEAD + f"components: {{a: {{rate: 0.01 /start, {clock}}}}}\nusage: {{starts: 1 start/h}}")


def test_silence_of_what_tells_is_no_silence_of_a_sensor() -> None:
    """A healthy node says nothing: of its log nothing is stale."""
    monitor = Monitor(ROBOT)
    for one in ticks(1):
        monitor.observe(one)
        monitor.observe(Sample(one.time, CLOCK, 0.0))
    report = monitor.report(remaining_life=False)
    assert not [flag for one in report.subjects for flag in one.flags if LOG in flag or CAMERA in flag]
    assert LOG not in report.silent
