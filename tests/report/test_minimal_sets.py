"""What it takes to fail, as the page says it: against closed forms of the parts' lives."""

import html
import math
import re

import numpy as np
import pytest

from robophm.blocks.cut_sets import MinimalSets
from robophm.blocks.diagram import Parallel, Series, Unit
from robophm.blocks.listed_sets import list_sets
from robophm.core.signal import HOUR, SECOND
from robophm.design.file import parse
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.report import minimal_sets
from robophm.report.health_page import health_page
from robophm.report.minimal_sets import counted, what_it_takes_to_fail
from robophm.transports.synthetic import SyntheticOta

DESIGN = """
schema_version: 1
name: Rover
clocks: {kilometres: {topic: /ota/odom, position: [pose.pose.position.x, pose.pose.position.y]}}
components:
  Frame: {rate: 2e-4 /h}
  Motor: {rate: 1e-3 /h, quantity: 2, required: 1}
  "<Lamp>": {rate: 3e-2 /h, quantity: 3, required: 2}
  Pump: {rate: 5e-3 /h}
  Spare pump: {rate: 5e-3 /h}
diagram:
  series:
    - Frame
    - Motor
    - "<Lamp>"
    - standby: {of: [Pump, Spare pump], dormancy: 0}
"""


@pytest.fixture(scope="module")
def rover():
    robot = parse(DESIGN)
    day = SyntheticOta(seed=3, start=1_709_553_600 * SECOND, duration=20 * HOUR, period=30 * SECOND)
    return robot, replay(robot, day)


def said(robot, report):
    """Paragraphs, and the rows of the table."""
    body = list(what_it_takes_to_fail(robot, report))
    rows = [
        [html.unescape(cell) for cell in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row)]
        for part in body
        for row in re.findall("<tr>(.*?)</tr>", part, re.DOTALL)
    ]
    return [part for part in body if "<table" not in part], rows[1:]


def test_the_likeliest_sets_have_the_probabilities_of_their_lives(rover):
    robot, report = rover
    hours = report.clocks["operating"]
    assert hours > 5
    words, rows = said(robot, report)
    frame, motor, lamp = (-math.expm1(-rate * hours) for rate in (2e-4, 1e-3, 3e-2))
    pumps = 1 - math.exp(-5e-3 * hours) * (1 + 5e-3 * hours)  # a cold spare: Erlang
    two = {f"<Lamp>[{i}], <Lamp>[{j}]": lamp**2 for i, j in ((1, 2), (1, 3), (2, 3))}
    expected = {"Frame": frame, "Motor[1], Motor[2]": motor**2, **two}
    standby = next(row[0] for row in rows if row[0] not in expected)
    expected[standby] = pumps
    assert {row[0]: float(row[2]) for row in rows} == pytest.approx(expected, rel=1e-3)  # as rounded for people
    lamps = 3 * lamp**2 - 2 * lamp**3
    fails = 1 - (1 - frame) * (1 - motor**2) * (1 - lamps) * (1 - pumps)
    shares = {row[0]: float(row[3].removesuffix(" %")) / 100 for row in rows}
    assert shares == pytest.approx({name: p / fails for name, p in expected.items()}, rel=1e-2)
    assert [float(row[2]) for row in rows] == sorted((float(row[2]) for row in rows), reverse=True)
    both = sorted(("Frame", standby), key=lambda name: -expected[name])
    assert words == [
        f"Of 7 drawn, 2 parts fail the robot alone: {', '.join(both)}.",
        "In all 6 minimal cut sets: 2 of 1, 4 of 2 parts.",
    ]


def test_it_is_on_the_page_and_escaped(rover):
    page = health_page(*rover)
    body = page.split("<h2>What it takes to fail</h2>")[1].split("<h2>")[0]
    assert "&lt;Lamp&gt;[1], &lt;Lamp&gt;[2]" in body
    assert "<Lamp>" not in page


def test_a_new_robot_has_sets_and_no_likeliest():
    robot = parse(DESIGN)
    words, rows = said(robot, Monitor(robot).report())
    assert not rows
    assert words[1:] == ["In all 6 minimal cut sets: 2 of 1, 4 of 2 parts."]


def test_what_is_not_listed_is_counted(rover):
    """Fifty spare pairs and no more: 50 sets of 2, of which 10 are listed."""
    names = [f"P{i}" for i in range(50)]
    robot = parse(
        DESIGN.partition("components:")[0]
        + "components:\n"
        + "".join(f"  {name}: {{rate: 1e-3 /h, quantity: 2, required: 1}}\n" for name in names)
    )
    day = SyntheticOta(seed=3, start=1_709_553_600 * SECOND, duration=2 * HOUR, period=30 * SECOND)
    report = replay(robot, day)
    words, rows = said(robot, report)
    pair = math.expm1(-1e-3 * report.clocks["operating"]) ** 2
    assert words == [
        "Of 100 parts drawn, none fails the robot alone.",
        "In all 50 minimal cut sets: 50 of 2 parts.",
        f"40 more are not listed; their probabilities add up to {40 * pair:.3g}, of all {50 * pair:.4g}.",
    ]
    assert len(rows) == 10


@pytest.mark.parametrize(("limit", "least"), [("STEPS", 3), ("MOST_PARTS", 3)])
def test_what_takes_too_long_is_said(monkeypatch, rover, limit, least):
    monkeypatch.setattr(minimal_sets, limit, least)
    words, rows = said(*rover)
    assert not rows
    assert words[0].startswith("Of 7 drawn, 2 parts fail the robot alone: ")
    assert (
        words[1] == "What else fails it would take longer to find than a page may take; `robophm cutsets` has the time."
    )


@pytest.mark.full
def test_more_sets_than_digits_can_be_written():
    """3^9100 cut sets are a number of 4,342 digits, of which Python writes 4,300."""
    wide = Parallel(*(Series(*(Unit(f"{i} {j}") for j in range(3))) for i in range(9100)))
    listed = list_sets(MinimalSets.cuts(wide), np.full(27_300, 0.5), 1.0, most=1)
    power = 9100 * math.log10(3)
    assert counted(listed) == f"{10 ** (power % 1):.2f}e{math.floor(power)} minimal cut sets: all of more than 10"
