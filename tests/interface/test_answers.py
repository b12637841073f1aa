"""Each function answers as its command does, as rows, frames and pictures; what is not installed says how to get it."""

import json
import sys

import matplotlib as mpl
import pytest
from tests.drafting.robots import DATA, arm, record
from typer.testing import CliRunner

import robophm
from robophm.cli.app import app
from robophm.core.errors import PlugError

DESIGN = """
schema_version: 1
name: R
usage: {operating: 0.5}
functions: {drive: {series: [motor, bearing]}}
components:
  motor:
    quantity: 2
    required: 1
    rate: 1e-4 /h
    acceleration: {model: q10}
    signals: {temperature: {topic: /a, field: b, unit: degC}}
  bearing: {b10: 5000 h, life: {distribution: weibull, shape: 2}}
task: {duration: 2 h}
"""
LOG = "part,robot,exposure [h],censored\nmotor[1],r1,4000,no\nmotor[1],r1,3000,yes\nbearing,r2,9000,no\n"
READINGS = "time [h],value\n" + "".join(f"{10 * i},{1 + 0.004 * i + 0.01 * (-1) ** i}\n" for i in range(120))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    mpl.use("Agg")
    monkeypatch.chdir(tmp_path)
    files = {
        "robot.yaml": DESIGN, "log.csv": LOG, "readings.csv": READINGS,
        "costs.csv": "part,preventive,corrective\nbearing,80,900\n",
        "lives.csv": "time [h],censored\n410,no\n620,no\n730,no\n880,no\n1200,yes\n",
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def told(*words):
    return json.loads(CliRunner().invoke(app, [*words, "--json"]).stdout)


def test_what_a_command_says_as_json_is_what_its_function_answers(folder):
    said = told("importance", "robot.yaml", "--function", "drive", "--within", "100 h")["importance"]["sensor_based"]
    found = robophm.rows(robophm.importance("robot.yaml", "drive", hours=100.0))
    assert [(one["unit"], one["criticality"]) for one in said["units"]] == [
        (one["unit"], one["criticality"]) for one in found
    ]
    said = told("learn", "robot.yaml", "log.csv")["rates"]
    assert [(one["mode"], one["learned_rate"]) for one in said] == [
        (one["failure_mode"], one["learned_rate"]) for one in robophm.rows(robophm.learn("robot.yaml", ["log.csv"]))
    ]
    said = told("fit", "lives.csv")["fits"]
    assert [one["distribution"] for one in said] == [one.name for one in robophm.fit("lives.csv")]
    by_times = robophm.fit([410, 620, 730, 880], censored=[1200])
    assert [one.aic for one in by_times] == [one.aic for one in robophm.fit("lives.csv")]
    said = told("wear", "robot.yaml", "readings.csv", "--part", "bearing", "--threshold", "2.5")
    worn = robophm.wear("robot.yaml", "readings.csv", "bearing", threshold=2.5)
    assert said["remaining_life"]["bearing"]["fused"]["median"] == worn.lives["bearing"].with_wear.life.median
    said = told("maintain", "robot.yaml", "costs.csv", "--repetitions", "2")["parts"]
    plan = robophm.maintain("robot.yaml", "costs.csv")
    assert [one["every_hours"] for one in said] == [one["every_hours"] for one in robophm.rows(plan)]
    said = told("rate", "mil_hdbk_217f.fuse", "--set", "environment=vehicle")["hazard_rate"]
    assert said == robophm.rate("mil_hdbk_217f.fuse", environment="vehicle").value == 8e-8  # MIL-HDBK-217F 22.1
    said = told("predict", "robot.yaml", "--draws", "0")["subjects"][0]["sensor_based"]["remaining_life"]["median"]
    assert said == robophm.predict("robot.yaml").remaining_life().median


def test_a_robot_with_a_store_is_asked_about_its_past(folder):
    (folder / "drive.csv").write_text("time,/a.b\n0,30\n3600,30\n")
    robot = robophm.load("robot.yaml")
    with robophm.open_store("past.db") as store:
        robophm.replay(robot, "drive.csv", store=store)
    assert robophm.predict(robot, "past.db").clocks == robophm.replay(robot, "drive.csv").clocks
    assert robophm.maintain(robot, "costs.csv", "past.db").parts[0].due is not None
    assert robophm.learn(robot, "past.db").rates[0].failures == 0
    with pytest.raises(robophm.RobophmError, match="no such store"):
        robophm.predict(robot, "none.db")


def test_bindings_are_proposed_and_written_into_the_text(folder):
    bag = record(folder / "arm.mcap", arm())
    draft = robophm.new(DATA / "six_axis_arm.urdf")
    (folder / "arm.yaml").write_text(draft.text)
    found = robophm.bind("arm.yaml", bag, DATA / "six_axis_arm.urdf")
    elbow = next(one for one in found.proposals if (one.part, one.input) == ("elbow/gear", "load"))
    assert "effort[elbow_joint]" in found.text([elbow])
    assert "effort[wrist_1_joint]" not in found.text([elbow])
    assert found.text().count("topic:") == len(found.proposals)
    assert (folder / "arm.yaml").read_text() == draft.text


def test_answers_are_frames_with_a_row_each(folder):
    robot = robophm.load("robot.yaml")
    frame = robophm.frame(robophm.predict(robot, parts=True))
    assert frame.path.tolist() == ["R", "drive", "motor", "bearing"]
    assert frame.median_remaining_life.notna().all()
    assert robophm.frame(robot).failure_mode.tolist() == ["motor", "bearing"]
    fits = robophm.fit([410, 620, 730, 880], censored=[1200])
    assert robophm.frame(fits).distribution.tolist() == [one.name for one in fits]
    gains = robophm.importance(robot).replacements["sensor_based"].parts
    assert sorted(robophm.frame(gains).path) == ["bearing", "motor"]


def test_answers_are_drawn(folder):
    health = robophm.predict("robot.yaml")
    lines = robophm.plot(health).get_lines()
    assert [line.get_label() for line in lines] == ["nominal", "sensor-based"]
    hours, survives = lines[1].get_data()
    assert survives[100] == pytest.approx(health.survival_of_next(hours[100] / 2), rel=1e-9)  # half the day it is on
    bars = robophm.plot(robophm.importance(health)).patches
    assert {round(bar.get_width(), 12) for bar in bars} == {
        round(one["criticality"], 12) for one in robophm.rows(robophm.importance(health))
    }
    (points, _) = robophm.plot(robophm.fit([410, 620, 730, 880])).get_lines()
    assert points.get_xdata().tolist() == [410, 620, 730, 880]
    worn = robophm.wear("robot.yaml", "readings.csv", "bearing", threshold=2.5)
    readings, threshold, reached = robophm.plot(worn).get_lines()
    assert readings.get_xdata().tolist() == [10 * i for i in range(120)]
    assert threshold.get_ydata()[0] == 2.5
    assert reached.get_xdata()[0] == pytest.approx(1.5 / 0.0004, rel=0.1)  # 0.0004 an hour from 1 up to 2.5
    rows = [f"r{i},task,{i},0.9,{0 if i % 10 == 0 else 1},fetch" for i in range(200)]
    (folder / "predictions.csv").write_text("\n".join(["robot,kind,time,probability,outcome,task", *rows]))
    drawn = robophm.plot(robophm.calibrate("predictions.csv")).get_lines()
    (point,) = [line for line in drawn if line.get_marker() == "o"]
    assert (point.get_xdata()[0], point.get_ydata()[0]) == (pytest.approx(0.1), pytest.approx(0.1))
    with pytest.raises(robophm.RobophmError, match="cannot be drawn; expected a report"):
        robophm.plot(robophm.load("robot.yaml"))


@pytest.mark.parametrize(("module", "ask"), [("pandas", robophm.frame), ("matplotlib.pyplot", robophm.plot)])
def test_what_is_not_installed_says_how_to_get_it(folder, monkeypatch, module, ask):
    health = robophm.predict("robot.yaml")
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(PlugError, match=r"which is not installed .*: pip install robophm\[notebook\]"):
        ask(health)


def test_robots_and_answers_show_themselves_in_a_line_and_as_a_table(folder):
    robot = robophm.load("robot.yaml")
    assert repr(robot) == "<Robot 'R': 3 parts, 2 failure modes, 1 signals>"
    assert "<th>motor</th><td>2</td><td>0.0001 /h</td><td>/a.b</td>" in robot._repr_html_()
    health = robophm.predict(robot)
    for one in (robot, health, robophm.importance(robot), robophm.fit([1, 2, 3]), robophm.rate("mil_hdbk_217f.fuse",
                environment="GM"), *robophm.models("fuse").values()):  # fmt: skip
        assert len(repr(one)) < 1200
        assert "\n" not in repr(one)
    (folder / "named.yaml").write_text(DESIGN.replace("name: R", "name: '<b>'"))
    assert "<th>&lt;b&gt;</th>" in robophm.predict("named.yaml")._repr_html_()


TWINS = """
schema_version: 1
name: R
environment: GM
components:
  left: {part: smart_servo}
  right: {part: smart_servo}
  c1: {hazard: {model: mil_hdbk_217f.fuse}}
  c2: {hazard: {model: mil_hdbk_217f.fuse}}
  own: {rate: 1e-5 /h}
"""


def test_parts_rated_alike_of_which_nothing_was_seen_are_named_and_keep_their_rate(folder):
    (folder / "robot.yaml").write_text(TWINS)
    (folder / "log.csv").write_text("part,exposure [h],censored\nleft/motor,900,no\nleft/motor,500,yes\nown,100,yes\n")
    learned = robophm.learn("robot.yaml", ["log.csv"])
    assert {one.mode.path for one in learned.rates} == {"left/motor", "left/gears", "own"}
    (note,) = learned.notes
    assert note.startswith("smart_servo rates left, of which something was seen, and right, of which nothing was")
    assert told("learn", "robot.yaml", "log.csv")["notes"] == [note]
    (folder / "log.csv").write_text("part,exposure [h],censored\nleft,900,yes\nright,900,yes\nc1,900,yes\nc2,900,yes\n")
    assert not robophm.learn("robot.yaml", ["log.csv"]).notes
    (folder / "log.csv").write_text("part,exposure [h],censored\nc1,900,yes\n")
    (note,) = robophm.learn("robot.yaml", ["log.csv"]).notes
    assert note.startswith("mil_hdbk_217f.fuse rates c1,")
