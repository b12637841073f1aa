"""robophm calibrate: verdicts, exit codes, page, JSON."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from robophm.calibration.predictions import LEVELS
from robophm.cli import BREACHED, INVALID, OK, USAGE
from robophm.simulation.fleet import simulate

from ..web.conftest import SMALL
from ..web.test_honesty import RATE, fill

FLEET = Path(__file__).resolve().parents[2] / "examples" / "fleet" / "robot.yaml"

COLUMNS = ["robot", "kind", "time", "probability", "failure", "outcome", *(f"q{level:g}" for level in LEVELS),
           "fraction", "observed", "censored"]  # fmt: skip


@pytest.fixture
def history(tmp_path):
    """Writes predictions.csv: for each model the factor by which its failures are off, and whether lives are there."""

    def write(models, *, lives=True, named=True):
        rng = np.random.default_rng(31)
        failure = np.exp(rng.normal(-3, 0.5, 3000)).clip(max=0.45)
        failed = rng.random(3000) < failure
        life = rng.exponential(100, 300)
        with (tmp_path / "predictions.csv").open("w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerow([*COLUMNS, *(["model"] if named else [])])
            for name, factor in models.items():
                last = [name] if named else []
                for i, (q, f) in enumerate(zip(failure * factor, failed, strict=True)):
                    rows.writerow([f"r{i}", "task", i, 1 - q, q, int(not f), *[""] * 12, *last])
                for i, hours in enumerate(life if lives else ()):
                    quantiles = -100 * np.log1p(-np.array(LEVELS))
                    rows.writerow(
                        [f"r{i}", "life", i, "", "", "", *quantiles, -np.expm1(-hours / 100), hours, 0, *last]
                    )
        return tmp_path / "predictions.csv"

    return write


def test_verdicts_and_tables(inside, history):
    history({"robophm": 1, "R^d": 2})
    done = inside("calibrate", "predictions.csv")
    assert (done.returncode, done.stderr) == (OK, "")
    assert "robophm, tasks: Calibrated: " in done.stdout
    assert "robophm, remaining life: Calibrated: " in done.stdout
    assert "R^d, tasks: Not calibrated (p = " in done.stdout
    assert "Task completion" in done.stdout
    assert "\x1b" not in done.stdout


@pytest.mark.parametrize(
    ("models", "named", "code"),
    [
        ({"robophm": 1}, True, OK),
        ({"robophm": 2}, True, BREACHED),
        ({"other": 2}, True, BREACHED),
        ({"": 2}, False, BREACHED),
        ({"other": 2, "robophm": 1}, True, OK),
        ({"other": 1, "robophm": 0.4}, True, BREACHED),
    ],
)
def test_exit_codes(inside, history, models, named, code):
    history(models, lives=False, named=named)
    assert inside("calibrate", "predictions.csv").returncode == code
    assert inside("calibrate", "predictions.csv", "--json").returncode == code


def test_json(inside, history):
    history({"robophm": 1, "R^d": 2})
    document = json.loads(inside("calibrate", "predictions.csv", "--json").stdout, parse_constant=pytest.fail)
    assert next(iter(document)) == "schema_version"
    ours, paper = document["models"]
    assert [one["model"] for one in (ours, paper)] == ["robophm", "R^d"]
    assert (ours["rejected"], paper["rejected"]) == (False, True)
    assert paper["tasks"]["p_value"] < 1e-6
    assert ours["tasks"]["tasks"] == 3000
    assert len(ours["lives"]["coverage"]) == 3


def test_the_page_is_written_whole_or_not_at_all(inside, history):
    path = history({"robophm": 1})
    done = inside("calibrate", path, "--report", path.with_name("page.html"))
    assert done.returncode == OK
    assert "Report: " in done.stdout
    assert path.with_name("page.html").read_text(encoding="utf-8").startswith("<!doctype html>")
    before = path.read_bytes()
    refused = inside("calibrate", path, "--report", path)
    assert refused.returncode == INVALID
    assert path.read_bytes() == before
    assert inside("calibrate", path, "--report", path.parent / "no" / "page.html").returncode == INVALID


def test_a_mistake_is_one_line_and_leaves_no_page(inside, history):
    path = history({"robophm": 1}, lives=False)
    path.write_text(path.read_text().replace(",task,7,", ",task,7,1", 1), encoding="utf-8")
    done = inside("calibrate", path, "--report", path.with_name("page.html"))
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert done.stderr.count("\n") == 1
    assert "line 9, column 4 (probability)" in done.stderr
    assert not path.with_name("page.html").exists()
    assert inside("calibrate").returncode == USAGE


def test_an_impossible_outcome_is_said_in_words(inside, tmp_path):
    (tmp_path / "predictions.csv").write_text("robot,kind,time,probability,outcome\nr,task,0,1,0\nr,task,1,0.9,1\n")
    done = inside("calibrate", "predictions.csv", "--report", "page.html")
    assert done.returncode == BREACHED
    assert "Not calibrated (p = 0): what it called impossible happened; 1 of 2 tasks failed" in done.stdout
    assert done.stderr == ""


@pytest.fixture(scope="session")
def simulated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("simulated") / "fleet"
    simulate(FLEET, folder, 3, 2, 5)
    return folder


@pytest.fixture
def fleet(simulated, tmp_path):
    return shutil.copytree(simulated, tmp_path / "fleet")


def test_a_page_does_not_take_the_place_of_what_a_fleet_is_read_from(inside, fleet):
    before = {path: path.read_bytes() for path in fleet.rglob("*") if path.is_file()}
    for path in before:
        done = inside("calibrate", "fleet", "--report", path)
        assert done.returncode == INVALID
        assert "is read or kept by this command too" in done.stderr
    assert {path: path.read_bytes() for path in fleet.rglob("*") if path.is_file()} == before


def changed(column, value):
    """Another value in all rows of the first task of tasks.csv."""

    def change(fleet):
        with (fleet / "tasks.csv").open(newline="") as file:
            header, *rows = csv.reader(file)
        for row in [row for row in rows if row[:2] == rows[0][:2]]:
            row[header.index(column)] = value
        with (fleet / "tasks.csv").open("w", newline="") as file:
            csv.writer(file).writerows([header, *rows])

    return change


def endless(name):
    def change(fleet):
        (fleet / name).unlink()
        (fleet / name).symlink_to("/dev/zero")

    return change


def long_line(fleet):
    (fleet / "failures.csv").write_text("robot,part,time,event\n" + "x" * (1 << 21))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (changed("start", "-5"), "robot-1: a task starts before the first sample of its recording"),
        (changed("end", "1500000000"), "tasks.csv:2: ends at 1500000000, before it starts at 1767225600"),
        (changed("end", "1999999999"), "tasks.csv: tasks of robot-1 overlap; expected one after the other"),
        (changed("end", "1e99"), "tasks.csv:2: 1e99 is no time of this age"),
        (changed("robot", "../robot-1"), "tasks.csv:2: '../robot-1' is no robot; expected a name without strokes"),
        (changed("robot", "robot-9"), "robot-9.csv: no such file"),
        (changed("outcome", "ok"), "tasks.csv:2: outcome 'ok'; expected completed or failed"),
        (endless("tasks.csv"), "tasks.csv: is no regular file"),
        (endless("failures.csv"), "failures.csv: is no regular file"),
        (endless("recordings/robot-1.csv"), "robot-1.csv: is no regular file"),
        (endless("robot.yaml"), "robot.yaml: is more than 20 MB"),
        (long_line, "failures.csv:2: longer than 1048576 characters"),
    ],
    ids=lambda one: one if isinstance(one, str) else "",
)
def test_a_fleet_that_is_none_is_one_line(inside, fleet, change, says):
    change(fleet)
    done = inside("calibrate", "fleet")
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert says in done.stderr
    assert done.stderr.count("\n") == 1


def test_more_processes_than_robots_are_not_started(inside, fleet, monkeypatch):
    monkeypatch.setattr("robophm.calibration.fleet.ProcessPoolExecutor", None)  # three robots are one turn's work
    shutil.rmtree(fleet / "plans")
    assert inside("calibrate", "fleet", "--jobs", "256").returncode in (OK, BREACHED)


def test_a_model_named_in_terminal_codes_is_refused(inside, history):
    history({"\x1b[31mred": 1}, lives=False)
    done = inside("calibrate", "predictions.csv")
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert "line 2, column 19 (model): '\\x1b[31mred' has control characters" in done.stderr


@pytest.mark.parametrize(("rate", "code"), [(RATE, OK), (RATE / 20, BREACHED)])
def test_whether_a_robot_failed_as_often_as_it_promised(inside, tmp_path, rate, code):
    """Fifty days at a constant rate: 1200 h of it in all, 720 h in the last thirty days, less the hours of repair."""
    (tmp_path / "courier.yaml").write_text(SMALL)
    fill(tmp_path / "courier.yaml", tmp_path / "past.db", rate)
    done = inside("calibrate", "courier.yaml", "--store", "past.db", "--json")
    assert done.returncode == code, done.stderr
    month, whole = (said := json.loads(done.stdout))["spans"]
    assert (month["noted"], whole["noted"], said["of_others"]) == (1, 4, 1)
    assert month["promised"] == pytest.approx(720 * rate, rel=0.02)
    assert whole["promised"] == pytest.approx(1200 * rate, rel=0.02)
    done = inside("calibrate", "courier.yaml", "--store", "past.db")
    assert done.returncode == code
    assert ("does not hold" in done.stdout) == (code == BREACHED)
    assert "Not counted: 1 of parts" in done.stdout
    done = inside("calibrate", "courier.yaml")
    assert (done.returncode, done.stderr) == (
        INVALID,
        "error: courier.yaml: is a design; expected its past too: --store\n",
    )
