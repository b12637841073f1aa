"""Alarms follow from reports alone; when each begins and ends, beside plain loops over what was heard."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robophm.core.errors import DesignError
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.health.alarms import Alarm, Alarms
from robophm.health.doubtful_signals import Doubt, DoubtfulSignal
from robophm.health.worn import SeenWear, WearAlarm
from robophm.monitoring.monitor import Monitor

START = 1_700_000_040 * SECOND
T = "/t.c"


def robot(limits: dict[str, Any], **part: Any) -> Robot:
    signal = {"topic": "/t", "field": "c", "unit": "degC", "range": [-40, 125]}
    acceleration = {"model": "q10", "reference_temperature": "25 degC"}
    motor = {"rate": "0.01 /h", "acceleration": acceleration, "signals": {"temperature": signal}} | part
    design = {"schema_version": 1, "name": "R", "thresholds": limits, "components": {"motor": motor}}
    return parse(json.dumps(design))


class Course:
    """A robot and its alarms, a second at a time."""

    def __init__(self, robot: Robot, going_on: tuple[Alarm, ...] = ()) -> None:
        self.monitor, self.alarms = Monitor(robot, period=1), Alarms(going_on)
        self.second = 0
        self.log: list[Alarm] = []

    def hear(self, *celsius: float | None) -> None:
        for said in celsius:
            now = START + self.second * SECOND
            if said is not None:
                self.monitor.observe(Sample(now, T, said))
            self.monitor.observe(Sample(now, CLOCK, 0.0))
            self.log += self.alarms.look(self.monitor.report(remaining_life=False))
            self.second += 1

    def spans(self, what: str) -> list[tuple[int, int | None]]:
        """Begin and end of each alarm, in seconds of the course."""
        found = {one.begin: one for one in self.log if one.what == what}
        return [
            ((begin - START) // SECOND, None if one.end is None else (one.end - START) // SECOND)
            for begin, one in found.items()
        ]


@given(
    said=st.lists(st.sampled_from([30.0, 36.0, 41.0]), max_size=60), clear=st.sampled_from([None, 35.0]),
    delay=st.integers(0, 4),
)  # fmt: skip
def test_hysteresis_and_delay(said: list[float], clear: float | None, delay: int) -> None:
    """Above 40 for so long, until at most 35 again where that is stated."""
    level = {"limit": "40 degC", "delay": f"{delay} s"} | ({"clear": f"{clear} degC"} if clear else {})
    course = Course(robot({"signals": {T: {"above": level}}}))
    course.hear(*said)
    spans: list[tuple[int, int | None]] = []
    since: int | None = None
    for second, value in enumerate(said):
        if spans and spans[-1][1] is None:
            if value <= (clear or 40.0):
                spans[-1] = spans[-1][0], second
                since = None
        elif value > 40:
            since = second if since is None else since
            if second - since >= delay:
                spans.append((second, None))
        else:
            since = None
    assert course.spans(f"{T} above (error)") == spans
    assert course.log == [] or course.log[0].cause == f"{T}: 41 °C is above 40 °C"


def test_silence_neither_ends_nor_begins_an_alarm_and_is_told() -> None:
    """A signal above its limit falls silent, and is heard again; one that was well falls silent."""
    course = Course(robot({"signals": {T: {"above": "40 degC"}}}))
    course.hear(50.0, *[None] * 10)
    above, silent = f"{T} above (error)", f"warn {T} silent"
    assert course.spans(above) == [(0, None)]
    (open_,) = [one for one in course.alarms.open.values() if one.what == above]
    assert open_.doubt == f"rests on silence of {T}"
    assert course.spans(silent) == [(5, None)]
    assert course.log[-1].cause == f"{T} is silent: whether it is above 40 °C is not known"
    course.hear(50.0)
    assert course.alarms.open[above].doubt == ""
    assert course.spans(silent) == [(5, 11)]
    course.hear(30.0, *[None] * 10)
    assert course.spans(above) == [(0, 12)]
    assert course.spans(silent)[1:] == [(17, None)]


def test_a_figure_that_rests_on_silence_says_so_and_does_not_end() -> None:
    """At 45 °C λ is 0.04 /h; when the sensor has died it stays so, and nobody knows."""
    course = Course(robot({"hazard_rate": "0.03 /h", "warning": {"hazard_rate": "0.02 /h"}}))
    course.hear(45.0, *[None] * 10)
    for severity in ("error", "warn"):
        (one,) = [one for one in course.alarms.open.values() if one.severity == severity]
        assert one.what == f"robot hazard_rate ({severity})"
        assert one.doubt.startswith("rests on silence since 2023-11-14 22:14:00 UTC")
    course.hear(25.0)
    assert course.alarms.open == {}
    assert course.log[-1].ended_by == "hazard rate 0.01 /h is not above 0.02 /h"


def test_parts_have_limits_and_alarms_go_on_in_another_run() -> None:
    design = robot({}, thresholds={"warning": {"hazard_rate": "0.03 /h"}})
    course = Course(design)
    course.hear(45.0, 45.0)
    (one,) = course.alarms.open.values()
    assert (one.path, one.severity) == ("motor", "warn")
    assert course.monitor.report().warnings == ("motor: hazard rate 0.04 /h is above 0.03 /h",)
    later = Course(design, (Alarm.of(json.loads(json.dumps(one.to_json()))),))
    later.hear(45.0)
    assert later.log == []
    later.hear(25.0)
    assert later.spans(one.what) == [(0, 1)]
    other = Course(robot({}), (one,))
    other.hear(45.0)
    assert other.log[-1].ended_by.startswith("nothing looks for it any more")


def test_wear_its_changes_and_doubtful_signals_are_alarms_too() -> None:
    course = Course(robot({}))
    course.hear(25.0)
    report = course.monitor.report(remaining_life=False)
    change = WearAlarm(START, START, None, 7.0, 5.0)
    worn = SeenWear("motor", "motor", "/m.current", "reached", "h", 9, 6.0, last=7.0, alarms=(change,))
    doubt = Doubt(DoubtfulSignal(T, T, "has said 25 to the last digit", "if it is silent", None), 0.01, None)
    began = course.alarms.look(replace(report, wear=(worn,), doubts=(doubt,)))
    assert {one.what: (one.severity, one.cause) for one in began} == {
        "wear of motor": ("error", "wear of motor: has reached 6: it counts as failed"),
        "change of motor": ("warn", f"/m.current of motor {change.words}"),
        f"doubt of {T}": ("warn", f"{T} has said 25 to the last digit"),
    }
    assert course.alarms.look(replace(report, wear=(worn,), doubts=(doubt,))) == []
    well = replace(worn, state="no trend", alarms=(replace(change, end=START + 9),))
    ended = course.alarms.look(replace(report, wear=(well,)))
    assert {one.what for one in ended} == {one.what for one in began}
    assert all(one.end == report.time for one in ended)
    assert course.alarms.open == {}


@pytest.mark.parametrize(
    ("thresholds", "says"),
    [
        ({"hazard_rate": {"limit": "1 /h", "clear": "2 /h"}}, "thresholds/hazard_rate/clear: 2 is above the limit 1"),
        ({"reliability": {"limit": 0.9, "clear": 0.8}}, "thresholds/reliability/clear: 0.8 is below the limit 0.9"),
        ({"signals": {"/t.x": {"above": "1"}}}, "no signal '/t.x' is bound to a stress of a part; known: /t.c"),
        ({"signals": {T: {"above": "1 V"}}}, f"thresholds/signals/{T}/above/limit: unit 'V' does not measure"),
        ({"signals": {T: {}}}, f"thresholds/signals/{T}: has no limit"),
        ({"signals": {T: {"abov": "1 degC"}}}, "unknown key 'abov'; did you mean 'above'"),
        ({"reliability": {"limt": 0.9}}, "unknown key 'limt'; did you mean 'limit'"),
        ({"warning": {"survival": 0.9}}, "unknown key 'survival'; known: completion, hazard_rate, reliability"),
    ],
)
def test_wrong_limits_are_refused_in_words(thresholds: dict[str, Any], says: str) -> None:
    with pytest.raises(DesignError) as caught:
        robot(thresholds)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
