"""Wear read as a robot runs: the same from columns, samples and interrupted runs; in every figure; at little cost."""

import json
import math
import pickle
import re
import time
from itertools import pairwise

import numpy as np
import pytest

from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.design.task import Leg, Plan, Task
from robophm.health.ledger import Ledger
from robophm.health.task_report import task_report
from robophm.health.why import explain
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.worn_mode import WearOptions
from robophm.monitoring.block_monitor import BlockMonitor
from robophm.monitoring.live_loop import watch
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.monitoring.seen_wear import seen_wear
from robophm.monitoring.task_history import judge_on_the_way
from robophm.monitoring.wear_from_recordings import seen_in, wear_history, worn_in, worn_modes
from robophm.monitoring.wear_watch import WearWatch
from robophm.monitoring.worn_life import worn_lives
from robophm.report.health_page import health_page
from robophm.report.why import reasons, sentence
from robophm.stores.sqlite import SqliteStore
from robophm.transports.health_topics.report_fields import diagnostics
from robophm.transports.recordings.journal import Journal
from robophm.transports.recordings.opening import open_source
from robophm.transports.signals.source import SignalColumns
from robophm.transports.tasks import PlannedLeg, PlannedTask

DESIGN = """
schema_version: 1
name: cart
components:
  motor:
    failure_modes:
      brushes:
        rate: 20 FPMH
        wear: {topic: /motor, field: current, every: 60 s, threshold: 6,
               load: {topic: /motor, field: load, range: [2, 3]}}
      winding: {rate: 10 FPMH}
  fan: {rate: 5 FPMH, wear: {topic: /imu, field: z, reading: rms, every: 60 s, threshold: 4}}
  computer: {rate: 2 FPMH}
"""
ROBOT = parse(DESIGN)
START = 1_700_000_040 * SECOND
MINUTES = 90


def samples():
    """An hour and a half: the current at load rises by 1.8, to its threshold 20 min later; the fan does not wear."""
    rng = np.random.default_rng(4)
    found = []
    for i in range(MINUTES * 60):
        at, load = START + i * SECOND, rng.uniform(1.5, 3.5)
        found += [
            Sample(at, "/motor.load", float(load)),
            Sample(at, "/motor.current", 3.8 + i / 3000 + 4 * max(load - 3, 0) + 0.1 * float(rng.standard_normal())),
            Sample(at + 5, "/imu.z", float(rng.standard_normal())),
        ]
    return found


SAMPLES = samples()


@pytest.fixture(scope="module")
def lived():
    monitor = Monitor(ROBOT)
    for sample in SAMPLES:
        monitor.observe(sample)
    return monitor


@pytest.fixture(scope="module")
def journal(tmp_path_factory):
    path = tmp_path_factory.mktemp("wear") / "run.journal"
    with Journal(path, ROBOT.signals) as journal:
        for sample in SAMPLES:
            journal.write(sample)
    return path


def wear_of(ledger):
    return json.dumps({key: one.to_json() for key, one in ledger.wear.items()})


def test_a_worn_robot_in_another_process_is_the_same(lived):
    wear = seen_wear(ROBOT, lived.ledger)
    robot, ledger, again = pickle.loads(pickle.dumps((ROBOT, lived.ledger, wear)))
    assert Monitor(robot, ledger).report(wear=again).to_json() == lived.report(wear=wear).to_json()


def test_columns_and_interrupted_runs_give_the_same_readings_bit_for_bit(lived):
    by_block = Monitor(ROBOT)
    life = BlockMonitor(by_block)
    for part in np.array_split(np.arange(len(SAMPLES)), 7):
        columns: dict[str, list[Sample]] = {}
        for i in part.tolist():
            columns.setdefault(SAMPLES[i].signal, []).append(SAMPLES[i])
        life.observe({
            signal: SignalColumns(times := np.array([one.time for one in some]), times,
                                  np.array([one.value for one in some]))
            for signal, some in columns.items()
        })  # fmt: skip
    life.finish()
    assert wear_of(by_block.ledger) == wear_of(lived.ledger)
    again = Monitor(ROBOT)
    for sample in SAMPLES[: len(SAMPLES) // 2]:
        again.observe(sample)
    again = Monitor(ROBOT, Ledger.of(ROBOT, json.loads(json.dumps(again.ledger.to_json()))))
    for sample in SAMPLES[len(SAMPLES) // 2 :]:
        again.observe(sample)
    assert wear_of(again.ledger) == wear_of(lived.ledger)
    assert again.report().to_json() == lived.report().to_json()


def test_what_wear_finds_is_what_every_figure_has(lived, journal, tmp_path):
    """The current's time to its threshold bounds task, report and remaining life; nominal figures do not know of it."""
    history = wear_history(ROBOT, journal, worn_modes(ROBOT))
    found, _ = worn_in(history, worn_modes(ROBOT, "motor"), WearOptions(changes=False))
    (motor,) = found
    assert 0.1 < motor.wear.remaining.low < 1 / 3 < motor.wear.remaining.high < 1
    with SqliteStore(tmp_path / "store.db") as store:
        report = replay(ROBOT, journal, store=store)
        ledger = Ledger.of(ROBOT, store.ledger("cart"))
        kept = list(store.history("cart").reports())
    by_mode = {one.mode: one for one in report.wear}
    assert by_mode["motor/brushes"].state == "foretold"
    assert by_mode["fan"].state == "no trend"
    life = report.system.sensor_based.remaining_life
    assert life.median == pytest.approx(motor.wear.remaining.median, rel=0.05)
    assert report.system.nominal.remaining_life.median > 10_000
    lives = worn_lives(history.monitor.report(wear=()).outlooks["sensor_based"], found, seen_in(history, found))
    assert lives["motor/brushes"].with_wear.life.median == pytest.approx(life.median, rel=1e-3)
    monitor = Monitor(ROBOT, ledger)
    settled = monitor.exposure.settled(ledger)
    plan = Plan((Task((Leg(0.2),)), Task((Leg(2.0),))))
    said = task_report(monitor.plant, monitor.exposure, settled, plan, wear=seen_wear(ROBOT, settled), draws=0)
    soon, later = (one.sensor_based.probability for one in said.tasks)
    assert 0.7 < soon < 1
    assert later < 0.05
    assert said.tasks[1].nominal.probability > 0.999
    assert report.outlooks["sensor_based"].worn.keys() == {0}  # of the fan no trend shows: its stated rate stands
    worn = report.outlooks["sensor_based"].worn[0]
    reached, at_last = (float(worn.life.cumulative_hazard(worn.since + time)) for time in (0.2, 0.0))
    ever, never = (1 - worn.never) * np.exp([-reached, -at_last]), worn.never
    brushes = (ever[0] + never * math.exp(-20e-6 * 0.2)) / (ever[1] + never)
    assert soon == pytest.approx(brushes * math.exp(-(10 + 5 + 2) * 1e-6 * 0.2), rel=1e-9)
    assert [one["mode"] for one in kept[-1]["wear"]] == ["motor/brushes", "fan"]
    rate = kept[-1]["subjects"][0]["sensor_based"]["hazard_rate"]  # of all but the brushes, far from their end
    why = explain(report)
    assert re.search(
        r"motor decides it \(99\.999\d* % of the failures to come\): it is seen to wear\.", sentence(report, why)
    )
    assert any(line.startswith("  motor/brushes reaches 6 in 0.3") for line in reasons(why))
    assert rate == pytest.approx((10 + 5 + 2) * 1e-6, rel=1e-3)


def test_others_of_its_kind_teach_the_figures(lived):
    """Five motors whose brushes went the same way, to their end after 1.7 to 2 h; this one ends after 1.83 h."""
    ledger = lived.exposure.settled(lived.ledger)
    others = []
    for end in (1.7, 1.8, 1.85, 1.9, 2.0):
        hours = np.arange(0.0, end + 0.05, 0.05)
        others.append(Unit(hours, 3.8 + 2.2 * hours / end))
    alone, taught, again = (seen_wear(ROBOT, ledger, said)[0] for said in ({}, {"motor/brushes": others}, {}))
    assert again is alone
    for one in (alone, taught):
        assert one.early < 1 / 3 < one.late
    assert taught.late - taught.early != alone.late - alone.early
    report = lived.report(wear=(taught,))
    assert report.system.sensor_based.remaining_life.median == pytest.approx(taught.median, rel=0.05)


@pytest.mark.full
def test_a_run_that_was_killed_goes_on_where_it_was(lived, journal, tmp_path):
    """Two watches of half a journal each, by a store between, and one of all of it."""
    half = tmp_path / "half.journal"
    whole = journal.read_text().splitlines(keepends=True)
    half.write_text("".join(whole[: len(whole) // 2]))
    with SqliteStore(tmp_path / "store.db") as store:
        watch(ROBOT, open_source(half), store=store, period=60.0)
    rest = tmp_path / "rest.journal"
    rest.write_text("".join([line for line in whole if line.startswith("#")] + whole[len(whole) // 2 :]))
    with SqliteStore(tmp_path / "store.db") as store:
        ended = watch(ROBOT, open_source(rest), store=store, period=60.0)
    assert wear_of(ended.ledger) == wear_of(lived.ledger)
    (motor,) = (one for one in seen_wear(ROBOT, ended.ledger) if one.mode == "motor/brushes")
    assert motor.state == "foretold"


def test_a_new_part_wears_anew(lived):
    ledger = lived.ledger.copy()
    watching = WearWatch(ROBOT)
    assert len(watching.renewed(ledger)) == 2
    ledger.replace([ROBOT.modes[0].key])
    assert [one.mode for one in watching.latest(ledger)] == ["fan"]
    assert lived.ledger.wear.keys() == {ROBOT.modes[0].key, ROBOT.modes[2].key}  # the copy's alone was put in new
    report = Monitor(ROBOT, ledger).report()
    assert (
        report.system.sensor_based.remaining_life.median > 10 * lived.report().system.sensor_based.remaining_life.median
    )


def test_wear_is_foretold_anew_when_there_is_enough_that_is_new():
    watching, course = WearWatch(ROBOT, 0.5), Monitor(ROBOT)
    renewed, before = [], ()
    for k, sample in enumerate(SAMPLES[: 3 * 60 * 30]):
        course.observe(sample)
        if k % (3 * 60) == 0 and (found := watching.renewed(course.ledger)[:1]) != before:
            renewed.append(len(course.ledger.wear[ROBOT.modes[0].key].stretches))
            before = found
    assert 5 <= len(renewed) <= 8
    assert all(later > 1.5 * earlier for earlier, later in pairwise(renewed))  # each more than half as many again


def test_tasks_of_a_recording_are_judged_by_the_wear_there_was_then():
    """The same task, an hour in and at the end: what was read later is not known before."""
    monitor = Monitor(ROBOT)
    at = [START + minutes * 60 * SECOND for minutes in (60, 89)]
    told = [PlannedTask(time, "/task", (PlannedLeg(1200.0, 1.0),)) for time in at]
    judged = judge_on_the_way(monitor, told)
    for sample in SAMPLES:
        monitor.observe(sample)
    monitor.reach_marks()
    early, late = (one.predicted for one in judged())
    assert early["sensor_based"].probability > 0.95 > 0.7 > late["sensor_based"].probability
    assert early["nominal"].probability == late["nominal"].probability


@pytest.mark.full
def test_a_reading_costs_little(lived):
    """A sample of a signal of wear, folded as it comes: far below a millisecond."""
    monitor = Monitor(ROBOT, Ledger.of(ROBOT, json.loads(json.dumps(lived.ledger.to_json()))), period=1.0)
    later = [sample._replace(time=sample.time + 2 * MINUTES * 60 * SECOND) for sample in SAMPLES[:6000]]
    begun = time.process_time()
    for sample in later:
        monitor.observe(sample)
    assert (time.process_time() - begun) / len(later) < 1e-3


def test_every_face_says_which_parts_wear(lived, tmp_path):
    """The motor's current has changed and comes to its threshold; with a lower one it has reached it."""
    report = lived.report(alarms=True)
    document = report.to_json()
    assert {one["mode"]: one["state"] for one in document["wear"]} == {"motor/brushes": "foretold", "fan": "no trend"}
    page = health_page(ROBOT, report)
    assert "What is seen to wear" in page
    assert "no trend shows that leads to 4: it goes by its hazard" in page
    statuses = {one["name"]: one for one in diagnostics(report, "robophm")["status"]}
    assert statuses["robophm: wear of motor/brushes"]["message"].startswith("reaches 6 in ")
    worn = parse(DESIGN.replace("threshold: 6", "threshold: 4.5"))
    ledger = Ledger.of(worn, json.loads(json.dumps(lived.ledger.to_json())))
    reached = Monitor(worn, ledger).report()
    assert reached.system.sensor_based.remaining_life.median == 0.0
    assert reached.completion(Task((Leg(0.1),))).probability == 0.0
    assert reached.completion(Task((Leg(0.1),)), "nominal").probability > 0.999
    assert reached.state == reached.system.state == "warn"
    assert "wear: motor/brushes has reached its threshold" in reached.system.flags
    (status,) = (one for one in diagnostics(reached, "n")["status"] if one["name"] == "n: wear of motor/brushes")
    assert (status["level"], status["message"]) == (2, "has reached 4.5: it counts as failed")


def test_a_change_has_a_begin_an_end_and_a_level():
    """A fan that shakes for a quarter of an hour, among four hours of calm."""
    robot = parse(DESIGN.replace("every: 60 s, threshold: 4", "every: 60 s, threshold: 40"))
    monitor, rng = Monitor(robot), np.random.default_rng(7)
    for i in range(240 * 60):
        value = (3.0 if 150 * 60 <= i < 165 * 60 else 1.0) * float(rng.standard_normal())
        monitor.observe(Sample(START + i * SECOND, "/imu.z", value))
    report = monitor.report(alarms=True)
    (fan,) = report.wear
    alarm = max(fan.alarms, key=lambda one: one.level)
    minutes = [(at - START) / SECOND / 60 for at in (alarm.begin, alarm.raised, alarm.end)]
    assert minutes == pytest.approx([150.5, 150.5, 165.5], abs=15)  # as sharp as sums are
    assert alarm.usual == pytest.approx(1.0, abs=0.05)
    (status,) = (one for one in diagnostics(report, "n")["status"] if one["name"] == "n: wear of fan")
    assert " to 2023-" in next(one["value"] for one in status["values"] if one["key"].startswith("change"))
    assert "had changed from 2023-" in health_page(robot, report)
