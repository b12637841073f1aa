"""Predictions of a fleet: closed forms of fleets written by hand, and honesty about one that really fails."""

import csv
import json
from math import exp
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest

from robophm.calibration.fleet import CONTROLS, OURS, predict_fleet
from robophm.calibration.predictions import LEVELS
from robophm.calibration.score import score
from robophm.core.errors import RobophmError, SourceError
from robophm.simulation.fleet import simulate

DESIGN = Path(__file__).resolve().parents[2] / "examples" / "fleet" / "robot.yaml"
BEGIN = 1_767_225_600  # s


# Fleets written by hand: times in hours.


def at(hours):
    return f"{BEGIN + round(hours * 3600)}"


def fleet(folder, components, functions, tasks, events=(), *, ambient=25.0, plan=None, usage=None):
    """A fleet of one robot. Tasks: (start, outcome, [(hours, functions)]); events: (hour, part, event)."""
    (folder / "recordings").mkdir(parents=True)
    design = {
        "schema_version": 1,
        "name": "hand-made",
        "powered": {"topic": "/power", "field": "on"},
        "signals": {"temperature": {"topic": "/t", "field": "c", "unit": "degC", "max_age": "1e6 s"}},
        "usage": usage or {},
        "functions": functions,
        "components": components,
    }
    (folder / "robot.yaml").write_text(json.dumps(design))
    on = [(start, start + sum(h for h, _ in legs)) for start, _, legs in tasks]
    power = [f"{at(t)},{k},{ambient}" for span in on for t, k in zip(span, (1, 0), strict=True)]
    (folder / "recordings" / "r1.csv").write_text("\n".join(["time,/power.on,/t.c", f"{at(0)},0,{ambient}", *power]))
    rows = [
        f"r1,{j},{at(start)},{at(start + sum(h for h, _ in legs))},{outcome},{hours} h,{needed}"
        for j, (start, outcome, legs) in enumerate(tasks)
        for hours, needed in legs
    ]
    (folder / "tasks.csv").write_text("\n".join(["robot,task,start,end,outcome,duration,functions", *rows]))
    said = [f"r1,{part},{at(hour)},{event}" for hour, part, event in events]
    (folder / "failures.csv").write_text("\n".join(["robot,part,time,event", *said]))
    if plan:
        (folder / "plans").mkdir()
        (folder / "plans" / "r1.yaml").write_text(json.dumps({"schema_version": 1, **plan}))
    return folder


def failures(folder):
    return predict_fleet(folder).tasks["robophm"].failure.tolist()


def exact(values):
    return pytest.approx(values, rel=1e-11)


def weibull(begin, end):
    """Of shape 2 and scale 10 h, given that it works at the age at which it begins."""
    return -np.expm1(-(end**2 - begin**2) / 100)


def pair(one, other, hours):
    """Two parts of 0.1 /h, not known to work for so long; at least one works now. P(neither does at the end)."""
    lost = [-np.expm1(-0.1 * age) for age in (one, other, one + hours, other + hours)]
    return (lost[2] * lost[3] - lost[0] * lost[1]) / (1 - lost[0] * lost[1])


Q10 = {"model": "q10", "q": 2, "reference_temperature": "25 degC"}
WEAR = {"life": {"distribution": "weibull", "scale": "10 h", "shape": 2}, "acceleration": Q10, "duty": 0.25}
STEADY = {"rate": "0.1 /h"}
TWO = {"A": WEAR, "B": STEADY}
LIFT_AND_DRIVE = {"lift": "A", "drive": "B"}
BOTH = {"S1": STEADY, "S2": STEADY}
TOGETHER = {"both": {"parallel": ["S1", "S2"]}, "one": "S1"}


def test_a_part_that_a_leg_does_not_need_ages_by_its_duty(tmp_path):
    legs = [
        (0, "completed", [(2, "drive")]),
        (5, "completed", [(1, "lift"), (2, "drive")]),
        (9, "failed", [(1, "lift")]),
    ]
    third = weibull(0.5 + 1 + 0.5, 3.0)
    second = 1 - (1 - weibull(0.5, 1.5)) * exp(-0.3)
    found = predict_fleet(fleet(tmp_path / "f", TWO, LIFT_AND_DRIVE, legs)).tasks["robophm"]
    assert found.failure.tolist() == exact([-np.expm1(-0.2), second, third])
    assert found.completion.tolist() == exact([exp(-0.2), 1 - second, 1 - third])
    assert found.failed.tolist() == [False, False, True]


def test_what_sensors_said_ages_and_being_off_does_not(tmp_path):
    """Twice as fast at 35 °C. A task that states no stress goes on as of late; after a rest, as designed."""
    legs = [(0, "completed", [(2, "lift")]), (2, "completed", [(1, "lift")]), (100, "completed", [(1, "lift")])]
    folder = fleet(tmp_path / "f", TWO, LIFT_AND_DRIVE, legs, ambient=35.0)
    assert failures(folder) == exact([weibull(0, 2), weibull(4, 6), weibull(6, 7)])


@pytest.mark.parametrize("duty", [0, 0.1])
def test_a_part_that_was_idle_of_late_works_as_much_as_any_when_it_is_needed(tmp_path, duty):
    """By the design's usage: a leg states no cycles. The rest of the minutes before does not say how fast it works."""
    arm = {"rate": "0.01 /cycle", "clock": "cycles", "duty": duty}
    legs = [
        (0, "completed", [(1, "drive")]),
        (1, "completed", [(1, "lift"), (1, "drive")]),
        (3, "failed", [(1, "lift")]),
    ]
    folder = fleet(tmp_path / "f", {"A": arm, "B": STEADY}, LIFT_AND_DRIVE, legs, usage={"cycles": "30 cycle/h"})
    assert failures(folder) == exact([-np.expm1(-0.1), -np.expm1(-0.5), -np.expm1(-0.3)])


def test_the_order_of_rows_does_not_matter(tmp_path):
    legs = [(0, "completed", [(2, "drive")]), (3, "completed", [(1, "lift")])]
    one, other = (fleet(tmp_path / n, TWO, LIFT_AND_DRIVE, rows) for n, rows in (("a", legs), ("b", legs[::-1])))
    (other / "recordings" / "r1.csv").write_bytes((one / "recordings" / "r1.csv").read_bytes())
    assert failures(one) == failures(other)


def test_a_replaced_part_is_new(tmp_path):
    legs = [(0, "completed", [(4, "lift")]), (5, "completed", [(1, "lift")])]
    assert failures(fleet(tmp_path / "old", TWO, LIFT_AND_DRIVE, legs))[1] == exact(weibull(4, 5))
    folder = fleet(tmp_path / "new", TWO, LIFT_AND_DRIVE, legs, [(4.5, "A", "failed"), (4.5, "A", "replaced")])
    assert failures(folder)[1] == exact(weibull(0, 1))
    folder = fleet(tmp_path / "then", TWO, LIFT_AND_DRIVE, legs, [(2, "A", "replaced")])
    assert failures(folder)[1] == exact(weibull(2, 3))


def test_the_failure_of_a_monitored_part_is_known_until_it_is_replaced(tmp_path):
    monitored = dict.fromkeys(BOTH, STEADY | {"monitored": True})
    legs = [(0, "completed", [(2, "both")]), (3, "completed", [(1, "both")]), (5, "completed", [(1, "both")])]
    events = [(1, "S1", "failed"), (4.5, "S1", "replaced")]
    found = failures(fleet(tmp_path / "f", monitored, TOGETHER, legs, events))
    assert found == exact([pair(0, 0, 2), -np.expm1(-0.1), pair(0, 0, 1)])


def test_a_silent_failure_is_not_looked_at(tmp_path):
    legs = [(0, "completed", [(2, "both")]), (3, "completed", [(1, "both")])]
    told = failures(fleet(tmp_path / "told", BOTH, TOGETHER, legs, [(1, "S1", "failed")]))
    assert told == failures(fleet(tmp_path / "untold", BOTH, TOGETHER, legs))
    assert told == exact([pair(0, 0, 2), pair(2, 2, 1)])


def test_an_inspected_part_worked_then(tmp_path):
    legs = [(0, "completed", [(2, "both")]), (3, "completed", [(1, "both")])]
    found = failures(fleet(tmp_path / "f", BOTH, TOGETHER, legs, [(2.5, "S1", "inspected")]))
    assert found[1] == exact(pair(0, 2, 1))
    found = failures(fleet(tmp_path / "g", BOTH, TOGETHER, legs, [(0.5, "S1", "inspected")]))
    assert found[1] == exact(pair(1.5, 2, 1))


def test_an_inspected_part_tells_of_what_it_shares_with_another(tmp_path):
    """S1 worked at 2.5 h, so no common cause had struck by then; what became of S2 alone is not known."""
    legs = [(0, "completed", [(2, "both")]), (3, "completed", [(1, "both")])]
    three = {"both": {"parallel": ["S1", "S2", "S3"]}}
    folder = fleet(tmp_path / "f", BOTH | {"S3": STEADY}, three, legs, [(2.5, "S1", "inspected")])
    design = json.loads((folder / "robot.yaml").read_text())
    design["common_causes"] = {"heat": {"of": ["S1", "S2"], "beta": 0.25}}
    (folder / "robot.yaml").write_text(json.dumps(design))

    def lost(one, other, cause, third):
        pair = exp(-0.025 * cause) * (1 - np.expm1(-0.075 * one) * np.expm1(-0.075 * other))
        return (1 - pair) * -np.expm1(-0.1 * third)

    now = lost(0, 2, 0, 2)
    assert failures(folder)[1] == exact((lost(1, 3, 1, 3) - now) / (1 - now))


def test_a_completed_task_proves_the_parts_without_which_it_would_have_failed(tmp_path):
    legs = [(0, "completed", [(2, "one"), (1, "both")]), (4, "completed", [(1, "both")])]
    assert failures(fleet(tmp_path / "f", BOTH, TOGETHER, legs))[1] == exact(pair(1, 3, 1))
    legs[0] = (0, "failed", legs[0][2])
    assert failures(fleet(tmp_path / "g", BOTH, TOGETHER, legs))[1] == exact(pair(3, 3, 1))


def test_remaining_life_by_the_plan(tmp_path):
    """One exponential part, on for 2 of 10 hours."""
    plan = {"every": "10 h", "tasks": [{"legs": [{"duration": "2 h"}]}]}
    legs = [(0, "completed", [(2, "")])]
    events = [(10, "", "end"), (31.5, "", "failed")]
    found = predict_fleet(fleet(tmp_path / "f", {"A": STEADY}, {"do": "A"}, legs, events, plan=plan)).lives["robophm"]
    whole, rest = np.divmod(-np.log1p(-np.array(LEVELS)) / 0.1, 2)
    assert found.quantiles[0] == pytest.approx(10 * whole + rest, rel=3e-5)
    assert found.fraction[0] == exact(-np.expm1(-0.1 * (2 + 2 + 1.5)))
    assert (found.time[0], found.observed[0]) == (BEGIN / 3600 + 10, 21.5)


def test_a_robot_whose_end_was_not_seen_has_no_remaining_life(tmp_path):
    plan = {"every": "10 h", "tasks": [{"legs": [{"duration": "2 h"}]}]}
    legs = [(0, "completed", [(2, "")])]
    folder = fleet(tmp_path / "f", {"A": STEADY}, {"do": "A"}, legs, [(10, "", "end")], plan=plan)
    assert predict_fleet(folder).lives == {}


# Nothing of what comes later is looked at.


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("small") / "fleet"
    simulate(DESIGN, folder, 6, 8, 3)
    return folder


def altered(path, change):
    with path.open(newline="") as stream:
        header, *rows = csv.reader(stream)
    with path.open("w", newline="") as stream:
        csv.writer(stream).writerows(
            [header, *(new for row in rows if (new := change(dict(zip(header, row, strict=True)))))]
        )


@pytest.mark.full
def test_no_prediction_looks_at_what_comes_later(small, tmp_path):
    folder = tmp_path / "fleet"
    copytree(small, folder)
    with (folder / "tasks.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    numbers = list(dict.fromkeys((row["robot"], int(row["task"])) for row in rows))
    cut = {row["robot"]: row["start"] for row in rows if row["task"] == "4"}
    known = np.array([number <= 4 for _, number in numbers])

    def task(row):
        if float(row["start"]) >= float(cut[row["robot"]]):
            row["outcome"] = "completed" if row["outcome"] == "failed" else "failed"
        return row.values()

    def event(row):
        if float(row["time"]) > float(cut[row["robot"]]) and row["part"]:
            row["event"] = {"replaced": "inspected", "inspected": "replaced", "failed": "replaced"}[row["event"]]
        return row.values()

    altered(folder / "tasks.csv", task)
    altered(folder / "failures.csv", event)
    for robot, start in cut.items():
        altered(
            folder / "recordings" / f"{robot}.csv",
            lambda row, start=start: [
                value if float(row["time"]) <= float(start) or "temperature" not in name or not value else "75"
                for name, value in row.items()
            ],
        )
    was, now = (predict_fleet(one).tasks["robophm"].failure for one in (small, folder))
    assert was[known].tolist() == now[known].tolist()
    assert np.mean(was[~known] != now[~known]) > 0.5  # what was altered does matter to those that may know it


@pytest.mark.full
def test_when_a_robot_fails_at_last_does_not_change_what_was_foretold(small, tmp_path):
    folder = tmp_path / "fleet"
    copytree(small, folder)
    ends = {}

    def event(row):
        if row["event"] == "end":
            ends[row["robot"]] = float(row["time"])
        elif row["robot"] in ends and not row["part"]:
            row["time"] = f"{ends[row['robot']] + 3600:.3f}"
        return row.values()

    altered(folder / "failures.csv", event)
    was, now = (predict_fleet(one).lives["robophm"] for one in (small, folder))
    assert was.quantiles.tolist() == now.quantiles.tolist()
    assert now.observed == pytest.approx(np.ones(6))
    assert np.all(was.fraction != now.fraction)


@pytest.mark.full
def test_processes_change_nothing(small):
    heard = []
    one = predict_fleet(small, {**OURS, **CONTROLS})
    two = predict_fleet(small, {**OURS, **CONTROLS}, jobs=2, on_robot=lambda done, total: heard.append((done, total)))
    assert heard == [(i + 1, 6) for i in range(6)]
    assert list(one.tasks) == list(two.tasks) == ["robophm", *CONTROLS]
    for name, tasks in one.tasks.items():
        for column in ("failure", "completion", "failed"):
            assert getattr(tasks, column).tolist() == getattr(two.tasks[name], column).tolist()
    assert list(one.lives) == list(two.lives) == ["robophm"]
    for column in ("robot", "time", "quantiles", "fraction", "observed", "censored"):
        assert getattr(one.lives["robophm"], column).tolist() == getattr(two.lives["robophm"], column).tolist()


# Folders that are not such.

FIRST = f"r1,0,{at(0)},{at(2)},completed,2 h,drive"
SECOND = f"r1,1,{at(3)},{at(4)},completed,1 h,lift"


def broken(folder, name, old, new):
    fleet(folder, TWO, LIFT_AND_DRIVE, [(0, "completed", [(2, "drive")]), (3, "completed", [(1, "lift")])],
          [(2.5, "A", "replaced")])  # fmt: skip
    path = folder / name
    if new is None:
        path.unlink()
    else:
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))
    return folder


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("robot.yaml", "", None, "robot.yaml: no such file"),
        ("tasks.csv", "", None, "tasks.csv: no such file"),
        ("failures.csv", "", None, "failures.csv: no such file"),
        ("recordings/r1.csv", "", None, "r1.csv"),
        ("tasks.csv", "outcome", "outcom", "tasks.csv:1: no column 'outcome'; did you mean 'outcom'?"),
        ("failures.csv", "event", "evnt", "failures.csv:1: no column 'event'"),
        ("recordings/r1.csv", "/t.c", "/t.d", "r1.csv: no signal '/t.c'"),
        ("tasks.csv", f"{FIRST}\n{SECOND}", "", "failures.csv:2: robot 'r1' has no task in tasks.csv"),
        ("tasks.csv", SECOND, SECOND + ",", "tasks.csv:3: 8 cells; expected 7"),
        ("tasks.csv", SECOND, SECOND.replace("completed", "done"), "tasks.csv:3: outcome 'done'; expected completed"),
        ("tasks.csv", SECOND, SECOND.replace("lift", "lft"), "tasks.csv:3: "),
        ("tasks.csv", SECOND, SECOND.replace(at(3), "noon"), "tasks.csv:3: 'noon' is not a time"),
        ("tasks.csv", SECOND, SECOND.replace(at(3), "nan"), "tasks.csv:3: nan is no time"),
        ("tasks.csv", SECOND, SECOND.replace(at(4), "1e11"), "tasks.csv:3: 1e11 is no time"),
        ("tasks.csv", SECOND, SECOND.replace(at(4), at(2.9)), "tasks.csv:3: ends at"),
        ("tasks.csv", SECOND, SECOND.replace(at(3), at(1.5)), "tasks.csv: tasks of r1 overlap"),
        ("tasks.csv", FIRST, FIRST.replace(at(0), at(-1)), "r1: a task starts before the first sample"),
        ("failures.csv", at(2.5), at(-1), "r1: an event is before the first sample"),
        ("failures.csv", at(2.5), "soon", "failures.csv:2: 'soon' is not a time"),
        ("failures.csv", ",A,", ",C,", "failures.csv:2: unknown part 'C'"),
        ("failures.csv", "r1,", "r2,", "failures.csv:2: robot 'r2' has no task in tasks.csv; known: r1"),
        ("failures.csv", "replaced", "mended", "failures.csv:2: event 'mended'; expected failed, replaced"),
    ],
)  # fmt: skip
def test_a_folder_that_is_not_a_fleet_is_refused_in_a_line(tmp_path, name, old, new, said):
    folder = broken(tmp_path / "fleet", name, old, new)
    with pytest.raises(RobophmError) as caught:
        predict_fleet(folder)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_fleet_that_did_nothing_is_refused(tmp_path):
    folder = fleet(tmp_path / "fleet", TWO, LIFT_AND_DRIVE, [])
    with pytest.raises(SourceError, match=r"tasks\.csv: holds no tasks"):
        predict_fleet(folder)


def test_a_folder_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(SourceError, match="no such file"):
        predict_fleet(tmp_path / "fleet")


def test_what_is_wrong_with_a_robot_is_heard_from_another_process(tmp_path):
    folder = broken(tmp_path / "fleet", "recordings/r1.csv", "/t.c", "/t.d")
    with pytest.raises(SourceError, match=r"no signal '/t\.c'"):
        predict_fleet(folder, jobs=2)


# Honesty: a part of ``make calibrate``.


@pytest.mark.full
@pytest.mark.parametrize("robots", [800, 2000])
def test_predictions_are_honest_about_robots_that_really_fail(tmp_path, robots):
    """In one test, so that the fleet is predicted once however tests are shared out."""
    made = simulate(DESIGN, tmp_path / "fleet", robots, 3, 20)
    assert made.tasks >= 2.5 * robots
    assert made.failed >= robots / 10
    models = {one.model: one for one in score(predict_fleet(tmp_path / "fleet", {**OURS, **CONTROLS})).models}
    ours = models["robophm"]
    assert ours.task_verdict.finding == ours.life_verdict.finding == "calibrated"
    assert (ours.tasks.tasks, ours.tasks.failed) == (made.tasks, made.failed)
    for one in ours.tasks.bins:
        assert one.band[0] <= one.failed <= one.band[1]
    assert ours.lives.lives > 0.95 * robots
    for one in ours.lives.coverage:
        assert one.share == pytest.approx(one.level, abs=2 / robots**0.5)  # four deviations of a half
    assert models["paper R^d"].tasks.p_value < 1e-6
    assert models["rates off by 2"].tasks.p_value < 1e-6
    assert models["forgets the past"].tasks.logarithmic_score > ours.tasks.logarithmic_score
