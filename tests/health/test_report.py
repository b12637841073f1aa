"""The report: what JSON and a notebook are told, thresholds, and the figures by their short names."""

from __future__ import annotations

import json
import math
from html.parser import HTMLParser
from typing import Any

import pytest
from mpmath import mp, mpf

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.design.task import Leg, Plan, Task
from robophm.health.report import VIEWS, HealthReport
from robophm.health.reporting import health_now, look_ahead
from robophm.monitoring.monitor import Monitor

START = 1_700_000_040 * SECOND
WORN = {"rate": "1e-3 /h", "initial_exposure": "100 h"}  # R since new is exp(−0.1)
TASK = {"duration": "10 h"}


def report(components: dict[str, Any], **more: Any) -> HealthReport:
    """Of a robot that has just been switched on."""
    design = {"schema_version": 1, "name": "R", "components": components, "task": TASK, **more}
    observer = Monitor(parse(json.dumps(design)))
    observer.observe(Sample(START, "/t.c", 25.0))
    return observer.report()


@pytest.mark.parametrize(
    ("key", "kept", "breached", "says"),
    [
        ("hazard_rate", "1.001e-3 /h", "0.999e-3 /h", "hazard rate 0.001 /h is above 0.000999 /h"),
        ("reliability", 0.904, 0.905, "reliability 0.904837 is below 0.905"),
        ("remaining_life", "693 h", "694 h", "median remaining life 693.1 h is below 694 h"),
        ("completion", 0.99, 0.9901, "probability of task completion 0.99005 is below 0.9901"),
    ],
)
def test_each_threshold(key: str, kept: object, breached: object, says: str) -> None:
    assert report({"part": WORN}, thresholds={key: kept}).breaches == ()
    assert report({"part": WORN}, thresholds={key: breached}).breaches == (says,)


@pytest.mark.parametrize(
    ("limits", "state"),
    [
        ({"reliability": 0.905}, "error"),
        ({"reliability": 0.904, "warning": {"reliability": 0.905}}, "warn"),
        ({"reliability": 0.905, "warning": {"reliability": 0.91}}, "error"),
        ({"completion": 0.9901}, "error"),
        ({"warning": {"reliability": 0.904}}, "ok"),
    ],
)
def test_a_module_has_thresholds_of_its_own(limits: dict[str, Any], state: str) -> None:
    """R since new is exp(−0.1) = 0.9048, of the task of 10 h exp(−0.01) = 0.99005."""
    found = report({"spare": {"rate": "1e-9 /h"}}, modules={"M": {"components": {"part": WORN}, "thresholds": limits}})
    assert (found.system.state, found.subject("M").state) == ("ok", state)
    assert all(words.startswith("M: ") for words in found.breaches + found.warnings)
    assert bool(found.breaches) == (state == "error")
    told = {subject["path"]: subject["state"] for subject in found.to_json()["subjects"]}
    assert told == {"R": "ok", "M": state}


def test_a_silent_sensor_makes_stale_and_an_error_is_told_first() -> None:
    heat = {"signals": {"temperature": {"topic": "/t", "field": "c", "unit": "degC", "range": [0, 99]}}}
    part = {"p": WORN | {"acceleration": {"model": "q10"}}}
    still = {"reliability": 0.905, "warning": {"reliability": 0.91}}
    levels = {"Quiet": {"components": part, **heat}, "Bad": {"components": part, **heat, "thresholds": still}}
    design = {"schema_version": 1, "name": "R", "modules": levels}
    observer = Monitor(parse(json.dumps(design)))
    for second in range(100):
        observer.observe(Sample(START + second * SECOND, "clock", math.nan))
    report = observer.report()
    states = {subject.path: subject.state for subject in report.subjects}
    assert states == {"R": "stale", "Quiet": "stale", "Bad": "error"}
    assert report.stale == {"/t.c"}
    assert all(subject.stale == ("/t.c",) for subject in report.subjects)


def test_what_is_ahead_is_added_to_what_is_now() -> None:
    """In two steps as in one."""
    design = {"schema_version": 1, "name": "R", "modules": {"M": {"components": {"part": WORN}}}, "task": TASK}
    monitor = Monitor(parse(json.dumps(design)))
    now = health_now(monitor.plant, monitor.exposure, monitor.ledger)
    assert now.system.nominal.remaining_life is None
    assert now.system.nominal.completion is None
    assert look_ahead(now, parts=True) == monitor.report(settled=False, parts=True)
    assert look_ahead(now).components[0].remaining_life is None


def test_time_of_a_wanted_survival() -> None:
    life = report({"part": WORN}, thresholds={"survival": 0.9}).remaining_life()
    assert life.threshold == pytest.approx(float(-mp.log(mpf(0.9)) * 1000), rel=1e-12)
    assert report({"part": WORN}).remaining_life().threshold is None


@pytest.mark.parametrize("duration", [5.0, 0.0])
def test_a_plan_is_of_the_life_ahead_and_not_of_the_task(duration: float) -> None:
    """Every day hot for 5 h, 4 times the rate, or not on at all; the task states no stress: as of late, nominal."""
    hot = {"temperature": {"topic": "/t", "field": "c", "unit": "degC"}}
    part = WORN | {"acceleration": {"model": "q10"}}
    design = {"schema_version": 1, "name": "R", "components": {"part": part}, "signals": hot, "task": TASK}
    observer = Monitor(parse(json.dumps(design)))
    observer.observe(Sample(START, "/t.c", 25.0))
    found = observer.report(plan=Plan((Task((Leg(duration, stresses={"temperature": 45.0}),)),), every=24.0))
    for view in VIEWS:
        assert found.completion(Task.plain(0.0, 10.0), view).failure == pytest.approx(float(-mp.expm1(-mpf("0.01"))))
        assert found.reliability(10.0, view) == pytest.approx(float(mp.exp(-mpf("0.11"))))
    assert found.system.sensor_based.completion == found.completion(Task.plain(0.0, 10.0))
    round_ = mp.exp(-4 * mpf("0.001") * duration)  # and then 19 h off
    mean = (250 * (1 - round_) + 19 * round_) / (1 - round_) if duration else math.inf
    assert found.remaining_life().mean == pytest.approx(float(mean), rel=1e-6)


@pytest.mark.parametrize(
    "part",
    [
        WORN,
        {"rate": "1 /h", "initial_exposure": "1e6 h"},  # has failed
        {"rate": "1e-200 /h"},  # never fails
        {"life": {"distribution": "weibull", "scale": "1 h", "shape": 0.5}},  # infinite hazard at first
    ],
)
def test_json_has_no_infinity_and_no_nan(part: dict[str, Any]) -> None:
    health = report({"part": part}, functions={"work": "part"})
    text = json.dumps(health.to_json(), allow_nan=False)
    read = json.loads(text)
    assert (read["schema_version"], read["robot"], read["time"]) == (1, "R", START)
    assert (read["task"]["distance"], read["task"]["duration"], len(read["task"]["legs"])) == (0, 10, 1)
    for subject, told in zip(health.subjects, read["subjects"], strict=True):
        for view in ("nominal", "sensor_based"):
            rate = getattr(subject, view).hazard_rate
            assert told[view]["hazard_rate"] == (rate if math.isfinite(rate) else "Infinity")
            mean = getattr(subject, view).remaining_life.mean
            assert told[view]["remaining_life"]["mean"] == (mean if math.isfinite(mean) else "Infinity")


def test_a_robot_that_was_never_heard_can_be_told_of() -> None:
    design = parse(json.dumps({"schema_version": 1, "name": "R", "components": {"part": WORN}}))
    health = Monitor(design).report()
    assert (health.time, health.system.flags, health.system.nominal) == (None, (), health.system.sensor_based)
    assert json.loads(json.dumps(health.to_json(), allow_nan=False))["time"] is None


class Text(HTMLParser):
    """What a browser would show, and the tags that it would see."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.texts: list[str] = []
        self.tags: set[str] = set()
        self.feed(html)

    def handle_data(self, data: str) -> None:
        self.texts.append(data)

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.tags.add(tag)


def test_a_notebook_shows_names_as_they_are() -> None:
    name = "<script>alert('&amp;')<!--"
    module = {"modules": {name.replace("/", ""): {"components": {"part": WORN}}}}
    shown = Text(report({"other": WORN}, **module)._repr_html_())
    assert name in shown.texts
    assert shown.tags == {"table", "thead", "tbody", "tr", "th", "td"}
    assert "0.904837" in shown.texts  # the module since new
    assert "0.818731" in shown.texts  # and the robot, of two of them


def test_short_names() -> None:
    health = report({"part": WORN}, modules={"arm": {"components": {"hand": WORN}}}, functions={"hold": "arm"})
    assert health.reliability(hours=100) == pytest.approx(math.exp(-0.4), rel=1e-12)
    assert health.completion(Task.plain(0.0, 50.0)).probability == pytest.approx(math.exp(-0.1), rel=1e-12)
    assert health.remaining_life("nominal").median == pytest.approx(500 * math.log(2), rel=1e-12)
    assert [subject.path for subject in health.subjects] == ["R", "arm", "hold"]
    assert health.subject("arm").sensor_based == health.subject("hold").sensor_based
    assert [part.path for part in health.components] == ["arm/hand", "part"]
    with pytest.raises(RobophmError, match="no module or function 'leg'; known: R, arm, hold"):
        health.subject("leg")


def test_flags_belong_to_the_module_that_hears_the_signal() -> None:
    hot = {
        "signals": {"temperature": {"topic": "/h", "field": "c"}},
        "components": {"part": {**WORN, "acceleration": {"model": "q10"}}},
    }
    health = report({}, modules={"hot": hot, "cold": {"components": {"part": WORN}}})
    assert {subject.path: subject.flags for subject in health.subjects} == {
        "R": ("stale /h.c",),
        "hot": ("stale /h.c",),
        "cold": (),
    }
    assert {subject.path: subject.stale for subject in health.subjects} == {
        "R": ("/h.c",),
        "hot": ("/h.c",),
        "cold": (),
    }


@pytest.mark.parametrize("draws", [0.4, 1.5, 2000.2])
def test_a_fraction_of_a_draw_is_refused(draws: float) -> None:
    observer = Monitor(parse(json.dumps({"schema_version": 1, "name": "R", "components": {"A": WORN}})))
    with pytest.raises(RobophmError, match=rf"draws {draws}: expected a whole number of at least 0"):
        observer.report(draws=draws)
    assert observer.report(draws=0).uncertainty is None
