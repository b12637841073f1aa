"""robophm demonstrate, run as a newcomer does."""

import json

import pytest


def test_a_plan_in_words(inside):
    said = inside("demonstrate", "--reliability", "90 %", "--at", "100 h", "--confidence", "95 %", "--shape", "1.5",
                  "--duration", "48 h").stdout  # fmt: skip
    assert "Test 86 for 48 h each" in said
    assert "a reliability of 90 % at 100 h is demonstrated" in said


def test_a_mean_life_as_json(inside):
    found = json.loads(inside("demonstrate", "--mtbf", "200 h", "--allowed", "2", "--json").stdout)
    assert found["with_replacement"] == pytest.approx(1064, abs=1)  # 5.32 times, by NIST's guide


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ([], "--mtbf '5000 h'"),
        (["--reliability", "0.9"], "--at '1000 h'"),
        (["--reliability", "2", "--at", "5 h"], "--reliability 2"),
        (["--mtbf", "5 km"], "--mtbf"),
        (["--mtbf", "5 h", "--shape", "2"], "--shape 2"),
        (["--mtbf", "5 h", "--at", "2 h"], "no --at"),
        (["--reliability", "0.9", "--at", "1 h", "--confidence", "high"], "--confidence"),
    ],
)
def test_mistakes_are_one_line(inside, options, said):
    found = inside("demonstrate", *options)
    assert found.returncode == 3
    assert said in found.stderr
    assert found.stderr.count("\n") == 1
