"""Tasks of recordings: predicted when they came, actual as they were driven; by hand from the samples."""

from __future__ import annotations

import json
import math
from bisect import bisect_right
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robophm
from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.ledger import Ledger
from robophm.health.mission import completion
from robophm.health.outlooks import outlooks
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.task_history import TaskRecord, judge_tasks, too_unlikely
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta
from robophm.transports.tasks import DoneLeg, DoneTask, PlannedLeg, PlannedTask, driven_task, tasks_of

OTA = Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml"
VIEWS = ("nominal", "sensor_based")
HOT, WAY = 1e-2, 1e-1  # per hour and per kilometre
X, Y = "/ota/odom.pose.pose.position.x", "/ota/odom.pose.pose.position.y"
CELSIUS = "/ota/mobility/temperature.temperature"


def robot(**more: Any) -> Robot:
    """A part that ages faster while it is hot, and one that ages by the way."""
    components = {
        "hot": {"rate": f"{HOT} /h", "acceleration": {"model": "q10"}},
        "wheel": {"rate": f"{WAY} /km", "clock": "kilometres"},
    }
    heard = {
        "signals": {"temperature": {"topic": "/ota/mobility/temperature", "field": "temperature"}},
        "clocks": {"kilometres": {"topic": "/ota/odom", "position": ["pose.pose.position.x", "pose.pose.position.y"]}},
        "usage": {"kilometres": "1 km/h"},
    }
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **heard, **more}))


def exact(value: float, rel: float = 1e-12) -> Any:
    return pytest.approx(value, rel=rel, abs=0)


@pytest.fixture(scope="module")
def drive() -> SyntheticOta:
    """An hour of the synthetic robot."""
    return SyntheticOta(seed=3, duration=3600 * SECOND, working_hours=(0, 24))


@pytest.fixture(scope="module")
def told(drive: SyntheticOta, tmp_path_factory: pytest.TempPathFactory) -> list[PlannedTask | DoneTask]:
    """What it tells of its tasks, as recorded."""
    path = drive.record(tmp_path_factory.mktemp("history") / "hour.mcap")
    with Recording(path) as source:
        return list(tasks_of(source))


@pytest.fixture(scope="module")
def judged(drive: SyntheticOta, told: list[PlannedTask | DoneTask]) -> tuple[list[TaskRecord], Monitor]:
    return judge_tasks(robot(), drive, told)


class Truth:
    """What the samples say of stretches of time: temperature, which holds until the next, and the way."""

    def __init__(self, drive: SyntheticOta) -> None:
        samples = list(drive.samples([CELSIUS, X, Y]))
        self.heat = [(one.time, one.value) for one in samples if one.signal == CELSIUS]
        xs, ys = ([one.value for one in samples if one.signal == signal] for signal in (X, Y))
        self.times = [one.time for one in samples if one.signal == X]
        self.places = list(zip(xs, ys, strict=True))

    def stressed(self, start: int, end: int) -> float:
        """∫2^((T − 25)/10) dt [h]."""
        times = [time for time, _ in self.heat]
        inside = [start, *(time for time in times if start < time < end), end]
        return math.fsum(
            2 ** ((self.heat[bisect_right(times, a) - 1][1] - 25) / 10) * (b - a) / HOUR for a, b in pairwise(inside)
        )

    def kilometres(self, start: int, end: int) -> float:
        steps = zip(self.times[1:], pairwise(self.places), strict=True)
        return math.fsum(math.dist(*places) for time, places in steps if start < time <= end) / 1000


# The synthetic robot's hour.


def test_plans_and_what_was_done_of_them(judged: tuple[list[TaskRecord], Monitor], told: list[Any]) -> None:
    records, _ = judged
    plans, done = ([one for one in told if isinstance(one, kind)] for kind in (PlannedTask, DoneTask))
    assert len(done) >= 3
    assert [record.arrived for record in records] == [plan.time for plan in plans]
    finished = [record for record in records if record.done]
    assert [(record.start, record.end) for record in finished] == [(one.start, one.end) for one in done]
    for record in finished:
        assert record.planned
        assert record.done
        assert record.arrived is not None
        assert record.start is not None
        assert abs(record.start - record.arrived) < 2 * SECOND  # it sets off when the task comes
        assert len(record.planned.legs) == len(record.done.legs)
        assert record.planned.distance == pytest.approx(record.done.distance, rel=0.01)
        assert record.planned.duration < record.done.duration  # at full speed, without the loading


def test_what_the_2020_tool_would_have_said(judged: tuple[list[TaskRecord], Monitor], drive: SyntheticOta) -> None:
    """R since its window was opened, to the power of the last leg's kilometres; it knows constant rates alone."""
    design = parse("schema_version: 1\nname: R\ncomponents: {a: {rate: 1e-2 /h}}\n")
    begin = int(drive.times[0])
    for record in judged[0]:
        assert record.time == record.arrived is not None
        assert record.planned
        found = record.legacy(design, begin)["km/h"]
        works = math.exp(-1e-2 * (record.time - begin) / HOUR)
        assert found.reliability == exact(works)
        takes = record.planned.duration * 3600 / 3600**2  # seconds, divided by 3600 twice
        last = record.planned.legs[-1].distance / 1000
        assert found.predicted == exact((works * math.exp(-1e-2 * takes)) ** last, 1e-9)
        done = TaskRecord(None, record.start, record.end, None, None, record.done, None)
        assert done.time == record.start
        assert bool(done.legacy(design, begin)) == (record.done is not None)


@pytest.mark.parametrize(("off", "below"), [(1e-9, True), (-1e-9, False)])
def test_a_design_wants_more_than_was_predicted(
    judged: tuple[list[TaskRecord], Monitor], off: float, below: bool
) -> None:
    least = min(record.predicted["sensor_based"].probability for record in judged[0] if record.predicted)
    assert too_unlikely(judged[0], robot(thresholds={"completion": least + off})) == below
    assert not too_unlikely(judged[0], robot())


def stopped(drive: SyntheticOta, design: Robot, at: int) -> Monitor:
    """A monitor that heard nothing after a time, and knows that it has come."""
    observer = Monitor(design)
    for sample in drive.samples(design.signals):
        if sample.time <= at:
            observer.observe(sample)
    observer.observe(Sample(at, CLOCK, 0.0))
    return observer


@pytest.mark.full
def test_predicted_is_what_a_monitor_stopped_then_says(
    judged: tuple[list[TaskRecord], Monitor], drive: SyntheticOta
) -> None:
    for record in judged[0]:
        assert record.arrived is not None
        assert record.planned
        observer = stopped(drive, robot(), record.arrived)
        ledger = observer.exposure.settled(observer.ledger)
        assert ledger.integrated_to == record.arrived
        at = outlooks(observer.plant, observer.exposure, ledger)
        for view in VIEWS:
            assert record.predicted
            expected = completion(at[view], record.planned)
            assert record.predicted[view].probability == exact(expected.probability)
            assert record.predicted[view].failure == exact(expected.failure)


def test_predicted_by_hand(judged: tuple[list[TaskRecord], Monitor], drive: SyntheticOta) -> None:
    """Both parts are memoryless: λ·T at the mean stress of the last ten minutes, and by the way that is planned."""
    truth = Truth(drive)
    for record in judged[0]:
        assert record.arrived is not None
        assert record.planned
        assert record.predicted
        way = WAY * record.planned.distance / 1000
        assert record.predicted["nominal"].failure == exact(-math.expm1(-HOT * record.planned.duration - way))
        start = max(drive.times[0], record.arrived - 600 * SECOND)
        if record.arrived > start:
            mean = truth.stressed(start, record.arrived) / ((record.arrived - start) / HOUR)
            hot = -math.expm1(-HOT * mean * record.planned.duration - way)
            # The last ten minutes are kept in steps of a minute.
            assert record.predicted["sensor_based"].failure == exact(hot, 0.01)


def test_actual_is_the_exposure_that_was_observed(
    judged: tuple[list[TaskRecord], Monitor], drive: SyntheticOta
) -> None:
    truth = Truth(drive)
    finished = [record for record in judged[0] if record.done]
    for record in finished:
        assert record.actual
        assert record.start is not None
        assert record.end is not None
        hours, way = (record.end - record.start) / HOUR, WAY * truth.kilometres(record.start, record.end)
        hot = HOT * truth.stressed(record.start, record.end)
        assert record.actual["nominal"].failure == exact(-math.expm1(-HOT * hours - way), 1e-9)
        assert record.actual["sensor_based"].failure == exact(-math.expm1(-hot - way), 1e-9)
        for view in VIEWS:
            assert record.actual[view].probability == exact(1 - record.actual[view].failure)
    factors = [math.log1p(-one.actual["sensor_based"].failure) / math.log1p(-one.actual["nominal"].failure)
               for one in finished if one.actual]  # fmt: skip
    assert max(factors) / min(factors) > 1.1  # it warms up


def test_marks_leave_the_robots_own_ledger_as_it_is(drive: SyntheticOta, told: list[Any]) -> None:
    design = robophm.load(OTA)
    _, observer = judge_tasks(design, drive, told)
    plain = Monitor(design)
    for sample in drive.samples(design.signals):
        plain.observe(sample)
    assert json.dumps(observer.ledger.to_json()) == json.dumps(plain.ledger.to_json())
    assert observer.marks == []


def test_a_ledger_goes_on(drive: SyntheticOta, told: list[Any]) -> None:
    """What a robot lived before counts where a part may have failed unseen."""
    spare = {"spare": {"rate": "1e-3 /h"}, "main": {"rate": "1e-3 /h"}}
    design = robot(modules={"pair": {"components": spare, "diagram": {"parallel": ["spare", "main"]}}})
    ledger = Ledger.new(design)
    for total in (ledger.age, ledger.effective):
        total.add(np.full(len(design.modes), 500.0))
    new, worn = (judge_tasks(design, drive, told, ledger=one)[0] for one in (None, ledger))
    for one, other in zip(new, worn, strict=True):
        assert one.predicted
        assert other.predicted
        assert one.arrived is not None
        assert one.planned
        hours = one.planned.duration
        others = -math.expm1(-HOT * hours - WAY * one.planned.distance / 1000)
        for record, age in ((one, 0.0), (other, 500.0)):
            lived = age + (one.arrived - int(drive.times[0])) / HOUR
            now, then = (math.expm1(-1e-3 * at) ** 2 for at in (lived, lived + hours))
            pair = (then - now) / (1 - now)
            assert record.predicted
            assert record.predicted["nominal"].failure == exact(others + (1 - others) * pair, 1e-9)


# Plans and tasks that do not come in pairs.


def start_of(drive: SyntheticOta, seconds: float) -> int:
    return int(drive.times[0]) + round(seconds * SECOND)


def test_a_plan_without_a_speed(drive: SyntheticOta) -> None:
    plan = PlannedTask(start_of(drive, 700), "/ota/plan", (PlannedLeg(30.0, None), PlannedLeg(60.0, 0.5)))
    (silent,), _ = judge_tasks(robot(), drive, [plan])
    assert (silent.planned, silent.predicted, silent.done, silent.actual) == (None, None, None, None)
    assert (silent.arrived, silent.start, silent.end) == (plan.time, None, None)
    (spoken,), _ = judge_tasks(robot(), drive, [plan], speed=0.25)
    assert spoken.planned == Task((Leg(30 / 0.25 / 3600, 30.0), Leg(60 / 0.5 / 3600, 60.0)))
    assert spoken.predicted
    assert spoken.predicted["nominal"].failure == exact(-math.expm1(-HOT * 240 / 3600 - WAY * 0.09))


def test_what_was_done_without_a_plan_is_predicted_as_it_was_done(drive: SyntheticOta) -> None:
    done = DoneTask(start_of(drive, 700), start_of(drive, 1000), "/ota/task_time", (DoneLeg(80.0, 300 / 3600),))
    (record,), _ = judge_tasks(robot(), drive, [done])
    assert (record.arrived, record.planned, record.start, record.end) == (None, None, done.start, done.end)
    assert record.done == Task((Leg(300 / 3600, 80.0),))
    assert record.predicted
    assert record.predicted["nominal"].failure == exact(-math.expm1(-HOT * 300 / 3600 - WAY * 0.08))
    assert record.actual
    way = WAY * Truth(drive).kilometres(done.start, done.end)  # as measured, not as told
    assert record.actual["nominal"].failure == exact(-math.expm1(-HOT * 300 / 3600 - way), 1e-9)


def test_where_nothing_measures_the_way_it_is_as_told(drive: SyntheticOta) -> None:
    components = {"wheel": {"rate": f"{WAY} /km", "clock": "kilometres"}}
    signals = {"powered": {"topic": "/ota/battery", "field": "voltage"}, "usage": {"kilometres": "1 km/h"}}
    design = parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **signals}))
    legs = (DoneLeg(80.0, 200 / 3600), DoneLeg(0.0, 100 / 3600))
    done = DoneTask(start_of(drive, 700), start_of(drive, 1000), "/ota/task_time", legs)
    (record,), _ = judge_tasks(design, drive, [done])
    assert record.actual
    for view in VIEWS:
        assert record.actual[view].failure == exact(-math.expm1(-WAY * 0.08))  # type: ignore[index]


def test_each_plan_is_done_once_by_its_own_robot(drive: SyntheticOta) -> None:
    """The last plan before it, of as many legs and the same robot; what is left over was never done."""
    leg, driven = PlannedLeg(10.0, 0.5), DoneLeg(10.0, 20 / 3600)
    at = {second: start_of(drive, second) for second in range(0, 1000, 100)}
    tasks = [
        PlannedTask(at[100], "/ota/robot_task_list", (leg,)),
        PlannedTask(at[200], "/ota/robot_task_list", (leg, leg)),
        PlannedTask(at[300], "/other/robot_task_list", (leg,)),
        PlannedTask(at[400], "/ota/robot_task_list", (leg,)),
        DoneTask(at[400], at[500], "/ota/task_time", (driven,)),
        DoneTask(at[500], at[600], "/ota/task_time", (driven,)),
        DoneTask(at[700], at[800], "/ota/task_time", (driven,)),
    ]
    records, _ = judge_tasks(robot(), drive, tasks)
    found = [(one.arrived, one.start) for one in records]
    assert found == [
        (at[100], at[500]), (at[200], None), (at[300], None), (at[400], at[400]), (None, at[700]),
    ]  # fmt: skip
    assert [one.actual is None for one in records] == [False, True, True, False, False]
    assert all(one.predicted for one in records)


def test_functions_and_knowledge_are_of_all_tasks(drive: SyntheticOta) -> None:
    design = robot(functions={"roll": "wheel"})
    plan = PlannedTask(start_of(drive, 700), "/ota/plan", (PlannedLeg(500.0, 0.5),))
    options: dict[str, Any] = {"functions": ("roll",)}
    (rolls,), _ = judge_tasks(design, drive, [plan], **options)
    assert rolls.predicted
    assert rolls.predicted["nominal"].failure == exact(-math.expm1(-WAY * 0.5))
    (broken,), _ = judge_tasks(design, drive, [plan], **options, knowledge=Knowledge(failed=frozenset({"wheel"})))
    assert broken.predicted
    assert broken.predicted["nominal"].failure == 1.0


def test_legs_are_the_phases_of_what_was_done(drive: SyntheticOta) -> None:
    """However many legs they were: what was observed from the first to the last."""
    truth, start, middle, end = Truth(drive), *(start_of(drive, seconds) for seconds in (700.0, 850.5, 1000.25))
    legs = tuple(DoneLeg(1.0, (b - a) / HOUR) for a, b in pairwise((start, middle, end)))
    (both,), _ = judge_tasks(robot(), drive, [DoneTask(start, end, "/ota/task_time", legs)])
    assert both.actual
    hazard = HOT * truth.stressed(start, end) + WAY * truth.kilometres(start, end)
    assert both.actual["sensor_based"].failure == exact(-math.expm1(-hazard), 1e-9)


def test_tasks_outside_of_the_recording_see_its_ends(drive: SyntheticOta) -> None:
    """A plan from before the robot was heard is of a new robot; one from after it of the robot at its end."""
    leg = (PlannedLeg(100.0, 0.5),)
    early, late = (PlannedTask(start_of(drive, second), "/ota/plan", leg) for second in (-100, 5000))
    (before, after), observer = judge_tasks(robot(), drive, [early, late])
    assert before.predicted
    assert after.predicted
    assert before.predicted["sensor_based"] == before.predicted["nominal"]
    settled = observer.exposure.settled(observer.ledger)
    at = outlooks(observer.plant, observer.exposure, settled)["sensor_based"]
    assert after.planned
    assert after.predicted["sensor_based"].failure == exact(completion(at, after.planned).failure)


class Silent(SyntheticOta):
    """A recording with topics and no sample."""

    def samples(self, signals: object) -> Any:
        return iter(())


def test_a_recording_without_samples() -> None:
    drive = Silent(duration=60 * SECOND)
    plan = PlannedTask(start_of(drive, 10), "/ota/plan", (PlannedLeg(1.0, 1.0),))
    with pytest.raises(SourceError, match="no sample of the robot; expected some beside its tasks"):
        judge_tasks(robot(), drive, [plan])
    records, _ = judge_tasks(robot(), drive, [])
    assert records == []


# A turtle that nobody here drove.


def test_the_turtle(shared: Path) -> None:
    """28.35 m in 21.489 s: predicted at its start by what it drove, actual by the same as observed."""
    components = {"wheel": {"rate": f"{WAY} /km", "clock": "kilometres"}, "board": {"rate": f"{HOT} /h"}}
    clocks = {"kilometres": {"topic": "/turtle1/pose", "position": ["x", "y"]}}
    design = parse(
        json.dumps(
            {"schema_version": 1, "name": "T", "components": components, "clocks": clocks,
             "usage": {"kilometres": "1 km/h"}}
        )
    )  # fmt: skip
    with Recording(shared / "recordings" / "turtlesim.bag") as source:
        driven = driven_task(source, "/turtle1/pose")
        ((record,), _) = judge_tasks(design, source, [driven])
    assert record.done
    assert round(record.done.distance, 4) == 28.3520
    assert round(3600 * record.done.duration, 3) == 21.489
    expected = -math.expm1(-WAY * record.done.distance / 1000 - HOT * record.done.duration)
    for found in (record.predicted, record.actual):
        assert found
        for view in VIEWS:
            assert found[view].failure == exact(expected, 1e-9)  # type: ignore[index]
