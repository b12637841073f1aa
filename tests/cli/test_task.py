"""robophm task and predict: what a newcomer sees, and what a mistake or a hostile file makes of it."""

import json

import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from robophm.cli import BREACHED, INVALID, OK
from robophm.core.signal import SECOND

DESIGN = """
schema_version: 1
name: Duo
functions:
  drive: {series: [Wheel, Computer]}
  see: Camera
components:
  Wheel: {rate: 1e-4 /h, quantity: 2}
  Computer: {rate: 1e-5 /h}
  Camera: {rate: 1e-3 /h}
task: {distance: 250 m, speed: 0.3 m/s}
"""


@pytest.fixture(autouse=True)
def robot(tmp_path):
    (tmp_path / "robot.yaml").write_text(DESIGN)


@pytest.fixture
def asked(inside, tmp_path):
    """Ask about tasks as YAML, further words as on the command line."""

    def asked(text, *words):
        (tmp_path / "tasks.yaml").write_text(f"schema_version: 1\n{text}\n")
        return inside("task", "robot.yaml", "tasks.yaml", *words)

    return asked


def refused(done):
    assert (done.returncode, done.stdout) == (INVALID, "")
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
    return done.stderr


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("tasks: [{distance: 250 m, speed: 0 m/s}]", "tasks/0: expected a distance with a speed above zero"),
        ("tasks: [{distance: -250 m, speed: 1 m/s}]", "tasks/0/distance: -250 m is too small; expected at least 0 m"),
        ("tasks: [{duration: -1 h}]", "tasks/0/duration: -1 h is too small"),
        ("tasks: [{duration: 1 h, functions: [lift]}]", "no function 'lift'; known: drive, see"),
        ("tasks: [{duration: 1e300 h}]", "expected at most 1e+06 h"),
        ("tasks: [{duration: 1e999 h}]", "1e999 is not a finite number"),
        ("tasks: [{duration: .nan}]", "nan is not a finite number"),
        ("tasks: [{duration: 1 h, cycles: 1e308}]", "expected at most 1e+15"),
        ("tasks: []", "tasks.yaml:2: tasks: is empty; expected at least one"),
        ("tasks: [{legs: []}]", "tasks.yaml:2: tasks/0/legs: is empty; expected at least one"),
        (
            'tasks: [{name: "\\e[31mred", legs: [{duration: 1 h}]}]',
            "is not a name; expected text without control characters",
        ),
        ("tasks: [{duration: 1 h}]\nknowledge: {failed: [Camera], working: [Camera]}", "expected either, not both"),
        ("every: 1 s\ntasks: [{duration: 1 h}]", "is shorter than the tasks, which take 1 h"),
    ],
)
def test_a_wrong_task_is_one_line(asked, text, says):
    assert says in refused(asked(text))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--working", "Camera"), "Camera is said to have failed and to work; expected either"),
        (("--failed", "Camra"), "unknown part 'Camra'; did you mean 'Camera'?"),
        (("--store", "no.sqlite"), "no.sqlite: no such store"),
    ],
)
def test_a_wrong_word_is_one_line(asked, words, says):
    assert says in refused(asked("tasks: [{duration: 1 h}]\nknowledge: {failed: [Camera]}", *words))


@pytest.mark.parametrize("words", [("--repeat", "2"), ("--threshold", "0.5"), ("--future", "last")], ids=" ".join)
def test_a_recording_is_not_repeated(inside, recording, words):
    done = inside("task", "robot.yaml", recording, *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"Error: {words[0]}: not used for the tasks of a recording" in done.stderr


@pytest.mark.parametrize("file", ["/dev/zero", "/dev/null", ".", "no.yaml", "no.csv"])
def test_no_tasks_in_there(inside, file):
    refused(inside("task", "robot.yaml", file))


def test_a_missing_table_is_not_taken_for_a_design(inside, tmp_path):
    (tmp_path / "flights.csv").write_text("duration\n1 h\n")
    assert "no such file; did you mean 'flights.csv'?" in refused(inside("task", "robot.yaml", "flihgts.csv"))
    assert "did you mean 'robot.yaml'?" in refused(inside("task", "robt.yaml"))


def test_a_long_list_is_cut_for_people_alone(inside, tmp_path):
    (tmp_path / "tasks.csv").write_text("duration\n" + "1 h\n" * 300 + "9 h\n" + "1 h\n" * 300)
    done = inside("task", "robot.yaml", "tasks.csv")
    assert done.returncode == OK
    assert "Listed are the 200 likeliest to fail of 601 tasks; --json has all of them" in done.stdout
    assert "task 301 " in done.stdout
    assert "all of them" in done.stdout
    assert len(json.loads(inside("task", "robot.yaml", "tasks.csv", "--json").stdout)["tasks"]) == 601


@pytest.mark.full
def test_repeated_a_million_times_it_is_as_good_as_the_first_time(asked):
    done = asked("tasks: [{duration: 1 h}]", "--repeat", "1000000", "--threshold", "0.99")
    assert (done.returncode, done.stderr) == (OK, "")
    assert (
        "1,000,000 times, nominal: the first 99.88 % (fails 1 in 830), the last 99.88 % (fails 1 in 830)" in done.stdout
    )
    assert "below 99 % never" in " ".join(done.stdout.split())


def test_repetitions_that_nobody_lives_to_see_are_not_made_up(inside, tmp_path):
    (tmp_path / "robot.yaml").write_text(
        "schema_version: 1\nname: Pair\ndiagram: {parallel: [a, b]}\n"
        "components: {a: {rate: 0.1 /h}, b: {rate: 0.1 /h}}\ntask: {duration: 10 h}\n"
    )
    done = inside("task", "robot.yaml", "--repeat", "1000")
    assert done.returncode == OK
    assert "warning: nominal: ends after 669 repetitions; that so many succeed is less likely" in done.stderr
    found = json.loads(inside("task", "robot.yaml", "--repeat", "1000", "--json").stdout)["repetitions"]["nominal"]
    assert found["cut_short"]
    assert len(found["probability"]) == 669
    assert found["probability"][-1] == pytest.approx(0.36787944117144233)


def test_draws_are_bounded_by_how_many_rates_are_drawn(inside, tmp_path):
    parts = "".join(f"  p{i}: {{rate: 1e-9 /h, uncertainty: {{error_factor: 3}}}}\n" for i in range(400))
    (tmp_path / "robot.yaml").write_text(f"schema_version: 1\nname: R\ntask: {{duration: 1 h}}\ncomponents:\n{parts}")
    for command in ("task", "predict"):
        says = "--draws 100000: too many for so many uncertain rates; expected at most 75000"
        assert says in refused(inside(command, "robot.yaml", "--draws", "100000"))


def test_without_draws_nothing_is_said_of_the_design(asked):
    assert "(--draws 0)" in asked("tasks: [{duration: 1 h}]", "--draws", "0").stdout


def test_a_failed_part_breaches(inside, tmp_path):
    (tmp_path / "robot.yaml").write_text(DESIGN + "thresholds: {completion: 0.9}\n")
    assert inside("task", "robot.yaml").returncode == OK
    assert inside("task", "robot.yaml", "--failed", "Camera").returncode == BREACHED
    (tmp_path / "tasks.csv").write_text("distance,speed,functions\n250 m,0.3 m/s,drive\n")
    assert inside("task", "robot.yaml", "tasks.csv", "--failed", "Camera").returncode == OK


def test_why_a_recorded_task_cannot_be_read_is_said(inside, tmp_path):
    ros = get_typestore(Stores.ROS1_NOETIC)
    text = ros.types["std_msgs/msg/String"]("__import__('os').system('touch here')")
    with Writer(tmp_path / "tasks.bag") as bag:
        connection = bag.add_connection("/robot_task_list", "std_msgs/msg/String", typestore=ros)
        bag.write(connection, SECOND, ros.serialize_ros1(text, "std_msgs/msg/String"))
    says = refused(inside("task", "robot.yaml", "tasks.bag"))
    assert "tells of no task that can be read: no task in a message on /robot_task_list" in says
    assert not (tmp_path / "here").exists()
