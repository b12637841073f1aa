"""``robophm new``, ``robophm bind``: a design of what there is of a robot, asked on a terminal, never overwritten."""

import json
import os
import pty
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.drafting.robots import ARM, DATA, arm, diagnostics, joints, record

from robophm.design.file import load

URDF = DATA / "six_axis_arm.urdf"


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    return record(tmp_path_factory.mktemp("arm") / "arm.mcap", (one for one in arm() if one[0] < 60))


def test_it_writes_a_design_its_assumptions_and_its_tasks_and_says_ranges(inside, tmp_path, bag):
    done = inside("new", "robot.yaml", "--urdf", URDF, "--bag", bag, "--hours", "16", "--where", "factory")
    assert done.returncode == 0, done.stderr
    robot = load(tmp_path / "robot.yaml")
    assert len(robot.signals) == 12
    assert robot.usage.operating == pytest.approx(16 / 24)
    assert "Which battery does it have" in (tmp_path / "assumptions.md").read_text()
    assert "as seen in arm.mcap" in (tmp_path / "tasks.yaml").read_text()
    for said in ("5 %", "95 %", "hazard rate", "remaining life: the median", "PoTC", "ask the maker of the"):
        assert said in done.stdout
    assert inside("check", "robot.yaml").stdout.endswith("12 signals, 0 warnings\n")
    assert inside("task", "robot.yaml", "tasks.yaml").returncode == 0


def test_json_has_everything_with_its_grade(inside, tmp_path, bag):
    told = json.loads(inside("new", "robot.yaml", "--urdf", URDF, "--bag", bag, "--json").stdout)
    assert all(one["grade"] in "ABC" and one["source"] for one in told["parts"])
    assert {one["input"] for one in told["bound"]} == {"load", "temperature"}
    low, middle, high = told["ranges"]["failure"]
    assert 0 < low < middle < high < 1
    assert len(told["largest_unknowns"]) == 3


@pytest.mark.parametrize("there", ["robot.yaml", "assumptions.md", "tasks.yaml"])
def test_nothing_is_overwritten_without_being_told(inside, tmp_path, there):
    (tmp_path / there).write_text("mine")
    refused = inside("new", "robot.yaml", "--urdf", URDF)
    assert (refused.returncode, refused.stdout) == (3, "")
    assert "exists; expected a new name, or --force" in refused.stderr
    assert [path.name for path in tmp_path.iterdir()] == [there]
    assert (tmp_path / there).read_text() == "mine"
    assert inside("new", "robot.yaml", "--urdf", URDF, "--force").returncode == 0
    if there != "tasks.yaml":  # none was seen, and none is written
        assert (tmp_path / f"{there}.bak").read_text() == "mine"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--urdf", "absent.urdf"], "absent.urdf: cannot be read"),
        (["--urdf", URDF, "--where", "indors"], "did you mean 'indoor'"),
        (["--urdf", URDF, "--bom", "main.csv"], "expected FILE=MODULE"),
        (["--urdf", URDF, "--part", "imu"], "expected NAME=WORDS"),
        (["--urdf", URDF, "--bag", "absent.mcap"], "absent.mcap"),
        (["--urdf", URDF, "--bom", "absent.csv=Board"], "absent.csv"),
        ([], "nothing tells of a part"),
    ],
)
def test_a_mistake_is_one_line_and_leaves_nothing_behind(inside, tmp_path, words, says):
    refused = inside("new", "robot.yaml", "--computer", "none", "--battery", "none", *words)
    assert refused.returncode == 3
    assert says in refused.stderr
    assert "Traceback" not in refused.stderr
    assert list(tmp_path.iterdir()) == []


def test_an_update_keeps_what_was_edited_and_the_tasks(inside, tmp_path, bag):
    inside("new", "robot.yaml", "--urdf", URDF, "--computer", "jetson")
    path = tmp_path / "robot.yaml"
    path.write_text(path.read_text().replace("part: power_supply", "part: power_supply\n        mtbf: 90000 h"))
    (tmp_path / "tasks.yaml").write_text("mine")
    done = inside("new", "robot.yaml", "--urdf", URDF, "--bag", bag, "--update", "--hours", "12")
    assert done.returncode == 0, done.stderr
    assert "kept: power/power supply: edited by hand" in done.stdout
    assert "changed: usage" in done.stdout
    text = path.read_text()
    assert "mtbf: 90000 h" in text
    assert "ai_computer_module" in text  # answered when it was made
    assert len(load(path).signals) == 12
    assert (tmp_path / "tasks.yaml").read_text() == "mine"
    assert (tmp_path / "robot.yaml.bak").exists()


def test_a_robot_of_which_nothing_was_recorded_is_said_to_have_no_signals(inside, tmp_path):
    inside("new", "robot.yaml", "--urdf", URDF)
    said = (tmp_path / "assumptions.md").read_text()
    assert "## Signals\n\n- none: neither a recording nor a robot that runs told of any\n" in said


@pytest.mark.full
def test_an_update_without_what_it_was_drafted_of_is_refused(inside, tmp_path, bag):
    """Else its joints, or its signals, would go without a word."""
    inside("new", "robot.yaml", "--urdf", URDF, "--bag", bag)
    path = tmp_path / "robot.yaml"
    before = path.read_text()
    for given, says in [
        (("--urdf", URDF), f"drafted of --bag {Path(bag).name}; an update without would take out"),
        (("--bag", bag), f"drafted of --urdf {Path(URDF).name}; an update"),
        ((), f"drafted of --urdf {Path(URDF).name} and --bag {Path(bag).name}; an update"),
    ]:
        refused = inside("new", "robot.yaml", *given, "--update", "--hours", "12")
        assert (refused.returncode, says in refused.stderr) == (3, True), refused.stderr
        assert path.read_text() == before
    done = inside("new", "robot.yaml", "--urdf", URDF, "--bag", bag, "--update", "--hours", "12")
    assert done.returncode == 0, done.stderr
    assert len(load(path).signals) == 12


def test_an_update_of_what_is_not_there_says_so(inside):
    refused = inside("new", "robot.yaml", "--urdf", URDF, "--update")
    assert (refused.returncode, "robot.yaml: no such file" in refused.stderr) == (3, True)


def on_a_terminal(words, folder, answers):
    """What a command prints on a terminal where somebody types these lines, each once something is asked."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "robophm", *map(str, words)], cwd=folder, stdin=theirs, stdout=theirs, stderr=theirs,
        env={**os.environ, "COLUMNS": "160", "TERM": "dumb"},
    )  # fmt: skip
    os.close(theirs)
    said, waiting, seen, until = "", list(answers), 0, time.monotonic() + 60
    while time.monotonic() < until:
        if select.select([ours], [], [], 0.3)[0]:
            try:
                said += os.read(ours, 65536).decode(errors="replace")
            except OSError:  # the other end is closed
                break
        elif waiting and said[seen:].rstrip().endswith(":"):
            seen = len(said)
            os.write(ours, (waiting.pop(0) + "\n").encode())
    os.close(ours)
    return process.wait(10), said


def test_on_a_terminal_it_asks_at_most_seven_questions_and_takes_changes(tmp_path):
    answers = ["12", "indors", "indoor", "", "", "", "", "", "computer=jetson", "imu=pizza", ""]
    code, said = on_a_terminal(["new", "robot.yaml", "--urdf", URDF], tmp_path, answers)
    assert code == 0, said
    assert said.count("? [") - said.count("warning: 'indors'") == 7
    assert "did you mean 'indoor'" in said
    assert "warning: part 'pizza'" in said
    text = (tmp_path / "robot.yaml").read_text()
    assert "operating: 0.5" in text
    assert "ai_computer_module" in text


def test_bind_proposes_by_example_and_writes_what_is_accepted(inside, tmp_path, bag):
    inside("new", "robot.yaml", "--urdf", URDF)
    before = (tmp_path / "robot.yaml").read_text()
    shown = inside("bind", "robot.yaml", bag, "--urdf", URDF)
    assert "/joint_states.effort[elbow_joint]" in shown.stdout
    assert "nothing written; --yes accepts all" in shown.stdout
    assert (tmp_path / "robot.yaml").read_text() == before
    some = inside("bind", "robot.yaml", bag, "--urdf", URDF, "--accept", "elbow/gear: load")
    assert "1 of 12 written" in some.stdout, some.stderr
    assert list(load(tmp_path / "robot.yaml").signals) == ["/joint_states.effort[elbow_joint]"]
    assert inside("bind", "robot.yaml", bag, "--accept", "elbow/gear: lod").returncode == 3
    told = json.loads(inside("bind", "robot.yaml", bag, "--urdf", URDF, "--yes", "--json").stdout)
    assert len(told["proposals"]) == 11
    assert len(load(tmp_path / "robot.yaml").signals) == 12
    assert "# Strain wave gear, standard series, grade A" in (tmp_path / "robot.yaml").read_text()
    assert inside("replay", "robot.yaml", bag).returncode == 0


def test_bind_without_limits_says_why_no_load_is_bound(inside, tmp_path):
    moving = (joints(t, ARM, [0.0] * 6, [5.0] * 6) for t in range(10))
    other = (diagnostics(t, {"unrelated": 20.0}) for t in range(10))
    record(tmp_path / "a.mcap", (one for pair in zip(moving, other, strict=True) for one in pair))
    inside("new", "robot.yaml", "--urdf", URDF)
    said = inside("bind", "robot.yaml", "a.mcap")
    assert "nothing says what counts as 1" in said.stderr
    assert said.stdout == "nothing written\n"


def test_bind_says_what_it_saw_where_no_input_has_such_a_name(inside, tmp_path):
    record(tmp_path / "a.mcap", (diagnostics(t, {"unrelated temperature": 20.0}) for t in range(10)))
    inside("new", "robot.yaml", "--urdf", URDF)
    said = inside("bind", "robot.yaml", "a.mcap")
    start, end = "nothing written: no input of the design fits /diagnostics.", " by its name\n"
    assert said.stdout.startswith(start)
    assert said.stdout.endswith(end)
    assert "temperature" in said.stdout[len(start) : -len(end)]
