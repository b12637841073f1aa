"""Tasks told over ROS 1 while the robot runs, by rospy and with move_base's own messages."""

from __future__ import annotations

import math
import threading

import pytest

from robophm.design.file import parse
from robophm.health.report import HealthReport
from robophm.monitoring.live_loop import watch
from robophm.transports.ros1 import Ros1
from robophm.transports.signals.report_sink import JudgedTask, ReportSink
from robophm.transports.tasks.listener import topics_of

from ..listener import within
from .conftest import System

ROBOT = parse("""
schema_version: 1
name: R
clocks: {kilometres: {topic: /odom, position: [pose.pose.position.x, pose.pose.position.y]}}
signals: {temperature: {topic: /motor, field: temperature, unit: degC, range: [-40, 125]}}
components:
  motor: {rate: 36 /h, acceleration: {model: q10, reference_temperature: 25 degC}}
""")
"""At 35 °C it fails twice in 100 s."""

TALKER = """
from move_base_msgs.msg import MoveBaseActionFeedback, MoveBaseActionResult
rospy.init_node("robot")
motor = rospy.Publisher("/motor", Temperature, queue_size=10)
text = {n: rospy.Publisher("/r/" + n, String, queue_size=9) for n in ("robot_task_list", "task_time", "task_position")}
feedback = rospy.Publisher("/move_base/feedback", MoveBaseActionFeedback, queue_size=10)
result = rospy.Publisher("/move_base/result", MoveBaseActionResult, queue_size=10)
def work(seconds):
    end = rospy.Time.now() + rospy.Duration(seconds)
    while rospy.Time.now() < end:
        motor.publish(Temperature(header=Header(stamp=rospy.Time.now()), temperature=35.0)); rospy.sleep(0.02)
say("ready")
for each in (motor, feedback, result, *text.values()):
    heard(each)
work(3)
text["robot_task_list"].publish("[[0, 0, 0.5], [3, 4, 2], [3, 0, 1]]")
text["robot_task_list"].publish("__import__('os').system('touch /tmp/robophm-owned')")
started = rospy.Time.now()
def pose(x, y):
    m = MoveBaseActionFeedback(); m.status.goal_id.id = "goal"; m.status.status = 1
    m.feedback.base_position.pose.position.x = x; m.feedback.base_position.pose.position.y = y
    feedback.publish(m)
pose(0, 0); work(1); pose(3, 4); work(1)
m = MoveBaseActionResult(); m.status.goal_id.id = "goal"; m.status.status = 3
result.publish(m)
text["task_time"].publish("[1.5, 0.5]")
text["task_position"].publish("[[0, 0], [3, 4], [3, 0]]")
work(30)
"""


class Kept(ReportSink):
    def __init__(self) -> None:
        self.reports: list[HealthReport] = []
        self.tasks: list[JudgedTask] = []

    def publish(self, report: HealthReport) -> None:
        self.reports.append(report)

    def judged(self, task: JudgedTask) -> None:
        self.tasks.append(task)


@pytest.fixture(scope="module")
def kept(_running: System) -> tuple[Kept, Ros1]:
    told = Kept()
    with Ros1(_running.uri) as source:
        topics = [*topics_of(["/move_base"]), *(f"/r/{name}" for name in ("robot_task_list", "task_time"))]
        asked = {"sinks": [told], "task_topics": [*topics, "/r/task_position"], "period": 0.1}
        thread = threading.Thread(target=lambda: watch(ROBOT, source, **asked))  # type: ignore[arg-type]
        thread.start()
        process = _running.talk(TALKER)
        try:
            within(60, lambda: len(told.tasks) == 3)
        finally:
            source.close()
            thread.join(20)
            _running.stop(process)
    return told, source


def test_a_planned_task_is_judged_as_the_robot_was(kept: tuple[Kept, Ros1]) -> None:
    """10 s and 2 s at the designed 36 /h; sensor-based at twice that, as of the last ten minutes."""
    planned = next(task for task in kept[0].tasks if not task.done)
    assert (planned.topic, planned.distance) == ("/r/robot_task_list", 9.0)
    assert planned.duration * 3600 == pytest.approx(12, rel=1e-12)
    assert planned.completion["nominal"].probability == pytest.approx(math.exp(-36 * 12 / 3600), rel=1e-12)
    assert planned.completion["sensor_based"].probability == pytest.approx(math.exp(-72 * 12 / 3600), rel=1e-6)


@pytest.mark.parametrize(("topic", "driven"), [("/r/task_time", 9.0), ("/move_base/result", 5.0)])
def test_a_done_task_is_judged_by_what_it_took(kept: tuple[Kept, Ros1], topic: str, driven: float) -> None:
    """About 2 s at 35 °C; its beginning is known to a tick and a fiftieth of the time since."""
    done = next(task for task in kept[0].tasks if task.done and task.topic.startswith(topic.rpartition("/")[0]))
    assert done.distance == driven
    assert done.duration * 3600 == pytest.approx(2, abs=0.2)
    rate = -math.log(done.completion["sensor_based"].probability) * 3600 / 72
    assert rate == pytest.approx(2, abs=0.4)
    assert done.completion["sensor_based"].failure == pytest.approx(
        -math.expm1(2 * math.log(done.completion["nominal"].probability)), rel=0.02
    )


def test_what_is_no_task_is_counted_and_never_run(kept: tuple[Kept, Ros1]) -> None:
    from pathlib import Path

    assert not Path("/tmp/robophm-owned").exists()
    (words,) = [what for what in kept[1].notes if "no task in a message" in what]
    assert "/r/robot_task_list" in words


def test_reports_come_with_every_tick_and_later_with_what_is_ahead(kept: tuple[Kept, Ros1]) -> None:
    times = [report.time for report in kept[0].reports if report.time]
    assert times == sorted(set(times))
    assert len(times) > 20
    latest = kept[0].reports[-1].system.sensor_based
    assert latest.remaining_life is not None
    assert latest.hazard_rate == pytest.approx(72, rel=1e-9)
