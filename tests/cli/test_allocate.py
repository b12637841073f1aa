"""robophm allocate, run as a newcomer does."""

import json

import pytest

ROBOT = """
schema_version: 1
name: Pair
components:
  computer: {rate: 10 FPMH}
  motor: {rate: 50 FPMH}
"""


@pytest.fixture
def files(tmp_path):
    (tmp_path / "robot.yaml").write_text(ROBOT)
    (tmp_path / "offers.csv").write_text("part,cost,most\nmotor,20,2\ncomputer,90,1\n")


def test_a_budget_in_words(inside, files):
    said = inside("allocate", "robot.yaml", "offers.csv", "--budget", "50").stdout
    assert "motor     2" in said
    assert "for 40:" in said
    assert "proved: no other choice is better" in said


def test_a_goal_as_json(inside, files):
    found = json.loads(inside("allocate", "robot.yaml", "offers.csv", "--reliability", "98 %", "--json").stdout)
    assert (found["more"], found["cost"], found["best"]) == ({"motor": 1}, 20.0, True)


@pytest.mark.parametrize(
    ("table", "options", "said"),
    [
        ("part,cost\nmotr,2\n", ["--budget", "5"], "motor"),
        ("part,cost\nmotor,\n", ["--budget", "5"], "offers.csv:2: cost"),
        ("part,cost,most\nmotor,2,0\n", ["--budget", "5"], "offers.csv:2: most"),
        ("part,cost\nmotor,2\nmotor,3\n", ["--budget", "5"], "twice"),
        ("part,cost\nmotor,2\n", [], "either a budget or a reliability"),
        ("part,cost\nmotor,2\n", ["--reliability", "much"], "--reliability"),
    ],
)
def test_mistakes_are_one_line(inside, files, tmp_path, table, options, said):
    (tmp_path / "offers.csv").write_text(table)
    found = inside("allocate", "robot.yaml", "offers.csv", *options)
    assert found.returncode == 3
    assert said in found.stderr
    assert found.stderr.count("\n") == 1
