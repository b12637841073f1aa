"""The history of a robot on the command line: curves, events, the report as it was."""

import json
import re
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

import robophm
from robophm.core.signal import SECOND
from robophm.health.alarms import Alarm
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.stores.events import Event
from robophm.transports.recordings.recording import Recording


@pytest.fixture
def past(design, recording, tmp_path):
    """A store of the robot after a recording, with a restart in it."""
    robot = robophm.load(design)
    with robophm.open_store(tmp_path / "past.db") as store, Recording(recording) as source:
        replay(robot, source, store=store, report_every=90)
        reports = list(store.history(robot.identity).reports())
        restart = Event(reports[1]["time"] + 1, "restart", "", "begun again")
        store.save(robot.identity, store.ledger(robot.identity), (), (), [restart])
    return reports


def moment(time):
    return datetime.fromtimestamp(time // SECOND, UTC).strftime("%Y-%m-%dT%H:%M:%S")


def test_figures_are_those_of_the_reports(inside, design, past):
    done = inside("history", design, "--store", "past.db", "--json")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert said["times"] == [one["time"] for one in past]
    for view in ("nominal", "sensor_based"):
        rates = [one["subjects"][0][view]["hazard_rate"] for one in past]
        np.testing.assert_allclose(said["figures"][f"hazard_rate.{view}"]["mean"], rates, rtol=1e-7)
        lives = [one["subjects"][0][view]["remaining_life"]["median"] for one in past]
        np.testing.assert_allclose(said["figures"][f"remaining_life.{view}"]["mean"], lives, rtol=1e-7)
    assert "restart" in [event["kind"] for event in said["events"]]
    shorter = inside("history", design, "--store", "past.db", "--json", "--from", moment(past[2]["time"] + SECOND))
    assert json.loads(shorter.stdout)["times"] == [one["time"] for one in past[3:]]
    assert "restart" not in shorter.stdout


def test_in_words_and_as_a_page(inside, design, past, tmp_path):
    done = inside("history", design, "--store", "past.db", "--plot", "history.html", "--points", "4")
    assert done.returncode == 0, done.stderr
    assert re.search(r"λ \[1/h\] +sensor-based", done.stdout)
    assert "begun again" in done.stdout
    page = (tmp_path / "history.html").read_text()
    assert "Probability of having failed since new" in page
    assert "begun again" in page
    assert "<script" not in page


def test_what_was_noted_before_the_first_recording_has_no_time(inside, design, tmp_path):
    robot = robophm.load(design)
    with robophm.open_store(tmp_path / "new.db") as store:
        refused = inside("service", design, robot.modes[0].path, "--store", "new.db", "--replaced")
        assert (refused.returncode, refused.stderr.count("\n")) == (3, 1)
        assert "new.db: holds no robot's past yet" in refused.stderr
        store.save(robot.identity, Monitor(robot).ledger.to_json())
    part = robot.modes[0].path
    noted = inside("service", design, part, "--store", "new.db", "--replaced", "--note", "spare")
    assert noted.returncode == 0, noted.stderr
    done = inside("history", design, "--store", "new.db", "--plot", "history.html")
    assert done.returncode == 0, done.stderr
    assert re.search(r"before its first recording +replacement .*: spare", done.stdout)
    assert "1970" not in done.stdout


def test_the_report_as_it_was_then_says_how_old_it_is(inside, design, past):
    asked = past[1]["time"] // SECOND * SECOND + 30 * SECOND
    said = json.loads(inside("history", design, "--store", "past.db", "--at", moment(asked), "--json").stdout)
    assert said["report"] == past[1]
    assert said["hours_before"] == pytest.approx((asked - past[1]["time"]) / SECOND / 3600)
    done = inside("history", design, "--store", "past.db", "--at", moment(asked))
    assert " before)" in done.stdout
    early = inside("history", design, "--store", "past.db", "--at", "2001-01-01")
    assert "(the first, " in early.stdout


def test_alarms_of_the_log_are_told_once_each_with_begin_and_end(inside, design, past, tmp_path):
    begin, end = past[1]["time"] + 5, past[2]["time"] + 5
    alarm = Alarm("motor hot", "motor", "warn", begin, "motor is above 40 °C")
    with robophm.open_store(tmp_path / "past.db") as store:
        log = store.alarm_log(robophm.load(design).identity)
        for one in (alarm, replace(alarm, end=end, ended_by="motor is below 33 °C")):
            log.keep([one.to_json()])
    done = inside("history", design, "--store", "past.db", "--json")
    told = [one for one in json.loads(done.stdout)["events"] if "alarm" in one["kind"]]
    assert [(one["time"], one["kind"], one["subject"], one["said"]) for one in told] == [
        (begin, "alarm", "motor hot", "motor is above 40 °C"),
        (end, "alarm ended", "motor hot", "motor is below 33 °C"),
    ]
    done = inside("history", design, "--store", "past.db", "--to", moment(end))
    assert re.search(r"alarm +motor is above 40 °C", done.stdout)
    assert "alarm ended" not in done.stdout


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--store", "none.db"), "none.db: no such store"),
        (("--store", "past.db", "--from", "yesterday"), "--from 'yesterday': expected a date and time"),
        (("--store", "past.db", "--from", "2026-01-02", "--to", "2026-01-01"), "expected a time after"),
        (("--store", "past.db", "--at", "2026-01-02", "--to", "2026-01-01"), "--at is one time"),
        (("--store", "past.db", "--plot", "past.db"), "past.db"),
    ],
)
def test_a_mistake_is_one_line(inside, design, past, options, says):
    done = inside("history", design, *options)
    assert done.returncode == 3
    assert says in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_another_robot_is_not_taken_for_it(inside, past, tmp_path):
    other = tmp_path / "other.yaml"
    other.write_text("schema_version: 1\nname: other\ncomponents: {motor: {rate: 8 FPMH}}\n")
    for command in ("history", "alarms"):
        done = inside(command, other, "--store", "past.db")
        assert done.returncode == 3
        assert "knows no robot 'other'" in done.stderr
