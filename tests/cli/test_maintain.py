"""robophm maintain, run as a newcomer does."""

import json
import math
from datetime import timedelta

import icalendar
import numpy as np
import pytest

from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.transports.synthetic import SyntheticOta

ROBOT = """
schema_version: 1
name: courier
usage: {operating: 0.5, kilometres: 1.2 km/h}
components:
  battery: {rate: 120 FPMH, life: {distribution: weibull, shape: 3.5}}
  bearing: {quantity: 2, rate: 2e-5 /km, clock: kilometres, life: {distribution: weibull, shape: 2}}
  computer: {rate: 10 FPMH}
"""
COSTS = "part,preventive,corrective,corrective downtime,sensor,detects\nbattery,300,300,24 h,60,0.9\n\
bearing,80,120,8 h,,\ncomputer,900,900,24 h,,\n"


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    (tmp_path / "costs.csv").write_text(COSTS)
    return path


def test_what_it_says(inside, robot):
    words = ("maintain", robot, "costs.csv", "--setup", 100, "--downtime-cost", 50, "--repetitions", 200)
    text = inside(*words)
    assert text.returncode == 0
    assert "computer" in text.stdout
    assert "never by age" in text.stdout
    assert "Watching costs 60" in text.stdout
    said = json.loads(inside(*words, "--json").stdout)
    parts = {one["part"]: one for one in said["parts"]}
    assert parts["computer"]["age"] is None
    assert parts["battery"]["every_hours"] == pytest.approx(parts["battery"]["age"] * 2)  # it works half of the time
    assert parts["bearing"]["every_hours"] == pytest.approx(parts["bearing"]["age"] / 0.6)
    assert said["together"]["cost_per_hour"] < said["together"]["apart"]
    assert said["life_cycle"]["by_age"]["cost"] < said["life_cycle"]["failures_only"]["cost"]
    assert said["life_cycle"]["watched"]["investment"] == pytest.approx(60)


def test_of_a_robot_with_a_past(inside, design, tmp_path):
    SyntheticOta(seed=3, duration=600 * SECOND).record(tmp_path / "day.mcap")
    inside("replay", design, "day.mcap", "--store", "past.db")
    some = [part.path for part in load(design).all_components() if len(part.modes) == 1][:3]
    (tmp_path / "costs.csv").write_text("part,preventive,corrective\n" + "".join(f"{name},10,50\n" for name in some))
    said = json.loads(
        inside("maintain", design, "costs.csv", "--store", "past.db", "--repetitions", 50, "--json").stdout
    )
    assert {one["part"] for one in said["first"]} <= set(some)
    assert len(said["parts"]) == 3


def test_mistakes_are_one_line(inside, robot, tmp_path):
    for text, said in (
        ("part,preventive,corrective\nbatery,1,2\n", "no part 'batery' in the design; did you mean 'battery'"),
        ("part,preventive,corrective\nbattery,1,-2\n", "corrective: -2 is negative"),
        ("part,preventive,corrective\nbattery,1,1e300\n", "corrective: 1e300 is too much; expected at most 1e+15"),
        ("part,preventive,corrective\nbattery,0,2\n", "costs nothing is best done all the time"),
        ("part,preventive\nbattery,1\n", "corrective: is empty; expected a number"),
        ("part,preventive,corrective,detects\nbattery,1,2,0.5\n", "detects: is of a sensor"),
        ("part,preventive,corrective,downtime\nbattery,1,2,5\n", "'5' has no unit; expected e.g. '5 h'"),
        ("part,preventive,corrective\nbattery,1,2\nbattery,1,2\n", "'battery' stands twice"),
    ):
        (tmp_path / "bad.csv").write_text(text)
        failed = inside("maintain", robot, "bad.csv")
        assert (failed.returncode, failed.stdout) == (3, "")
        assert said in failed.stderr
        assert failed.stderr.count("\n") == 1
    for option, value, said in (
        ("--horizon", "5", "--horizon"),
        ("--setup", "inf", "--setup inf: expected a finite cost"),
        ("--downtime-cost", "1e300", "--downtime-cost 1e+300: expected a finite cost, at most 1e+15"),
        ("--horizon", "100000 year", "lives of parts of one robot, 2,000 times over; expected a shorter horizon"),
    ):
        assert said in inside("maintain", robot, "costs.csv", option, value).stderr


def test_redundancy(inside, tmp_path):
    """Of two pumps either will do: their downtime hardly counts, and the robot's availability is that of the pair."""
    pumps = "components: {pump: {quantity: 2, required: %d, rate: 1000 FPMH}, computer: {rate: 1 FPMH}}"
    (tmp_path / "costs.csv").write_text("part,preventive,corrective,corrective downtime\npump,10,10,100 h\n")
    said = {}
    for required in (1, 2):
        (tmp_path / "robot.yaml").write_text(f"schema_version: 1\nname: R\n{pumps % required}\n")
        words = ("maintain", "robot.yaml", "costs.csv", "--downtime-cost", 5, "--repetitions", 200)
        said[required] = json.loads(inside(*words, "--json").stdout)
        text = inside(*words).stdout
        assert ("pump is redundant: while it is down the robot stands still with 9.1 %" in text) == (required == 1)
    up = 1000 / 1100
    parts = {required: one["parts"][0] for required, one in said.items()}
    assert parts[1]["stops_robot"] == pytest.approx(1 - up)
    assert parts[1]["cost_per_hour"] == pytest.approx((10 + 500 * (1 - up)) / 1100)
    assert parts[2]["cost_per_hour"] == pytest.approx((10 + 500) / 1100)
    cycles = {required: one["life_cycle"]["failures_only"] for required, one in said.items()}
    assert cycles[1]["availability"] == pytest.approx(1 - (1 - up) ** 2, abs=2e-3)
    assert cycles[2]["availability"] == pytest.approx(up**2, abs=5e-3)
    assert cycles[1]["cost"] < 0.3 * cycles[2]["cost"]


WORN = """
schema_version: 1
name: cart
usage: {operating: 0.5}
components:
  belt:
    mtbf: 60 h
    life: {distribution: weibull, shape: 3}
    wear: {topic: /belt, field: slack, every: 60 s, threshold: 9}
  pump: {mtbf: 90 h}
"""


@pytest.mark.full
def test_a_part_that_is_inspected(inside, tmp_path):
    """Wear by steps towards 9: looking is cheaper than an age; a part whose wear nobody reads is said."""
    (tmp_path / "robot.yaml").write_text(WORN)
    rng = np.random.default_rng(5)
    slack = 1 + np.cumsum(rng.gamma(0.05, 0.4, 2 * 120))
    lines = ["# robophm journal 1\n", "# signal /belt.slack\n"]
    lines += [f"{(1_700_000_040 + 30 * i) * SECOND} {float(value)!r} /belt.slack\n" for i, value in enumerate(slack)]
    (tmp_path / "run.journal").write_text("".join(lines))
    inside("replay", "robot.yaml", "run.journal", "--store", "past.db")
    (tmp_path / "costs.csv").write_text("part,preventive,corrective,inspection\nbelt,30,400,0.5\npump,10,50,1\n")
    words = ("maintain", "robot.yaml", "costs.csv", "--store", "past.db", "--repetitions", 20)
    said = json.loads(inside(*words, "--json").stdout)["inspected"]
    belt = said["belt"]
    assert belt["others"] == 0
    assert 1 < belt["level"] < 9
    assert 0 <= belt["fail_before"] < 0.2
    assert belt["cost_per_hour"] < belt["by_age"] <= belt["never"]
    assert said["pump"] == {"why": "the design says no signal of its wear"}
    text = inside(*words).stdout
    assert "Replaced by the wear that is found" in text
    assert "belt: by its own forecast alone" in text
    assert "pump: when to replace it by inspection cannot be said" in text
    without = json.loads(inside("maintain", "robot.yaml", "costs.csv", "--repetitions", 20, "--json").stdout)
    why = "no readings of its wear, and no teachers in the design; expected a store that has some"
    assert without["inspected"]["belt"] == {"why": why}


def test_a_part_that_is_inspected_by_others_that_wore_out(inside, tmp_path):
    """Belts that all wear along t² within 95 to 105 h, and need no store: looked at cheaply, none has to fail."""
    (tmp_path / "robot.yaml").write_text(WORN.replace("threshold: 9}", "threshold: 9, teachers: belts.csv}"))
    rows = [f"{life},{t},{1 + 8 * (t / life) ** 2}\n" for life in range(95, 106) for t in range(life + 1)]
    (tmp_path / "belts.csv").write_text("unit,time [h],value\n" + "".join(rows))
    (tmp_path / "costs.csv").write_text("part,preventive,corrective,inspection\nbelt,30,400,0.01\n")
    words = ("maintain", "robot.yaml", "costs.csv", "--repetitions", 20)
    belt = json.loads(inside(*words, "--json").stdout)["inspected"]["belt"]
    assert belt["others"] == 11
    assert belt["fail_before"] < 0.01
    # Without a failure, and replaced just before the end, it would cost 30 a life of 100 h, of which half is used.
    assert 30 / 200 < belt["cost_per_hour"] < 1.2 * 30 / 200
    assert belt["cost_per_hour"] < belt["by_age"] < belt["never"]
    # A kind is taken to scatter somewhat more than eleven did.
    assert belt["never"] == pytest.approx(400 / 200, rel=0.03)
    assert "belt: by 11 of its kind that wore out" in inside(*words).stdout


AGED = ROBOT + "  puzzle: {rate: unknown}\n"


def test_what_is_due_needs_no_table_of_costs(inside, robot):
    """Of the battery H(a) = (a/η)^3.5 with η = 1e6/120/Γ(1 + 1/3.5), on for half of the time."""
    robot.write_text(AGED)
    text = inside("maintain", robot)
    assert text.returncode == 0
    assert "gains nothing, as their hazard does not rise with age: computer" in text.stdout
    said = json.loads(inside("maintain", robot, "--risk", 0.1, "--json").stdout)["ahead"]
    due = {one["part"]: one for one in said["due"]}
    eta = 1e6 / 120 / math.gamma(1 + 1 / 3.5)
    assert due["battery"]["due_in_hours"] == pytest.approx(2 * eta * (-math.log(0.9)) ** (1 / 3.5), rel=1e-9)
    assert [due[name]["state"] for name in ("computer", "puzzle")] == ["useless", "unknown"]
    assert due["puzzle"]["due_in_hours"] is due["puzzle"]["median"] is None
    assert (said["time"], said["risk"]) == (None, 0.1)
    computers = [one for one in said["replacements"] if one["name"] == "computer"]
    assert [one["expected"] for one in computers] == pytest.approx(
        [0.5 * 1e-5 * 168 * w for w in (4, 13, 52)], rel=1e-9
    )
    assert all(one["exact"] for one in computers)
    refused = inside("maintain", robot, "--setup", 3)
    assert refused.returncode == 2
    assert "--setup: not used for what is due, without a table of costs" in refused.stderr
    assert "risk 0.7: expected a number above 0 and at most 0.5" in inside("maintain", robot, "--risk", 0.7).stderr


def test_a_calendar_of_what_is_due(inside, robot, tmp_path):
    """Read by another's parser; its events keep their names while their days move."""
    robot.write_text(AGED.replace("name: courier", "name: 'Kurier; β, ééé'"))
    assert inside("maintain", robot, "--calendar", "out.ics", "--risk", 0.2).returncode == 0
    raw = (tmp_path / "out.ics").read_bytes()
    first = events(raw)
    assert inside("maintain", robot, "costs.csv", "--repetitions", 2, "--calendar", "out.ics").returncode == 0
    second = events((tmp_path / "out.ics").read_bytes())
    assert set(first) == set(second) == {"Kurier; β, ééé: replace battery", "Kurier; β, ééé: replace bearing"}
    for what, event in first.items():
        assert event["UID"] == second[what]["UID"]
        assert event.start > second[what].start  # a higher chance is reached later
        assert event.end - event.start == timedelta(days=1)
    assert "it wears out: it has aged 0 h" in str(second["Kurier; β, ééé: replace battery"]["DESCRIPTION"])
    assert max(len(line) for line in raw.split(b"\r\n")) <= 75
    assert raw.count(b"\n") == raw.count(b"\r\n")
    refused = inside("maintain", robot, "--calendar", robot)
    assert "is read or kept by this command too" in refused.stderr


def events(raw):
    calendar = icalendar.Calendar.from_ical(raw)
    assert calendar["VERSION"] == "2.0"
    assert not calendar.errors
    assert not any(event.errors for event in calendar.events)
    return {str(event["SUMMARY"]): event for event in calendar.events}
