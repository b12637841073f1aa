"""What will fail the robot, and what of it is of unknown rate: on every face of the command line."""

from __future__ import annotations

import json
import re

import pytest

from robophm.cli import INVALID, OK

from .conftest import EXAMPLE

UNKNOWN = """\
schema_version: 1
name: cart
modules:
  Power:
    components:
      cell: {rate: 100 FIT}
      charger: {rate: unknown, quantity: 3}
  Wheels:
    components:
      motor: {rate: 300 FIT, quantity: 2}
task: {distance: 100 m, speed: 1 m/s}
"""


@pytest.fixture
def cart(tmp_path):
    path = tmp_path / "cart.yaml"
    path.write_text(UNKNOWN)
    return path


def test_the_part_that_fails_the_robot_leads_and_not_the_highest_rate(inside):
    """Of the arm's encoders one of each two is enough; the drone's battery wears out."""
    for example, leads in (("arm", "Control/Controller"), ("drone", "Power/Battery ×2")):
        done = inside("show", EXAMPLE.parents[1] / example / "robot.yaml")
        assert done.returncode == OK
        _, _, told = done.stdout.partition("What will fail it: share of the failures within ")
        assert "the median remaining life" in told.splitlines()[0]
        assert told.splitlines()[2].startswith(leads)
    assert re.search(r"Battery ×2 +94 %", told)


def test_the_horizon_is_the_users(inside, cart):
    said = json.loads(inside("predict", cart, "--horizon", "1000 h", "--json").stdout)["failures_to_come"]
    assert (said["horizon"], said["stated"]) == (1000.0, True)
    assert "within 41.7 days\n" in inside("show", cart, "--horizon", "1000 h").stdout
    for wrong in ("0 h", "-1 h", "1e12 h", "5 km", "soon"):
        done = inside("predict", cart, "--horizon", wrong)
        assert done.returncode == INVALID
        assert "Traceback" not in done.stderr


def test_every_command_counts_what_is_of_unknown_rate(inside, cart):
    done = inside("check", cart)
    assert "6 parts, 3 of them of unknown rate" in done.stdout
    assert "3 parts of unknown rate are left out of the totals (Power/charger" in done.stderr
    assert json.loads(inside("check", cart, "--json").stdout)["parts_of_unknown_rate"] == 3
    shown = inside("show", cart).stdout
    assert re.search(r"cart +≥ 7e-7 /h +≤ 99\.93 % +≤ 163 years", shown)
    assert re.search(r"  Wheels +6e-7 /h +99\.94 % +190 years", shown)
    assert "λ is at least, R, remaining life and PoTC are at most what is stated (Power/charger)" in shown
    ahead = inside("predict", cart, "--parts").stdout
    assert re.search(r"cart \* +≥ 7e-7 /h", ahead)
    assert "Remaining life (calendar time): at most median" in ahead
    assert "completed with at most 99.999998 %" in ahead
    assert re.search(r"Power/charger +unknown +unknown +unknown", ahead)
    assert (
        "3 parts of unknown rate are left out of the totals: every PoTC is at most what is stated"
        in inside("task", cart).stdout
    )
    assert "fails within 1,000 h of operation with at least" in inside("importance", cart).stdout
    assert "1 failure mode of unknown rate" in inside("fmeca", cart).stdout
    assert "3 parts of unknown rate" in inside("cutsets", cart).stdout
    assert inside("report", cart, "--to", "health.html").returncode == OK


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (("show", "--legacy"), "Power/charger: its rate is unknown, which the 2020 tool would take for zero"),
        (("fault-tree", "--to", "tree.xml"), "3 parts of unknown rate would be written as never failing"),
    ],
)
def test_what_would_take_it_for_zero_refuses(inside, cart, command, words):
    done = inside(*command, cart)
    assert done.returncode == INVALID
    assert words in done.stderr


def test_a_report_of_unknown_parts_says_so(inside, cart, tmp_path):
    assert inside("report", cart, "--to", "health.html").returncode == OK
    page = (tmp_path / "health.html").read_text()
    assert "rate unknown" in page
    assert "3 parts of unknown rate" in page
    assert "≥ 7e-7 /h" in page
