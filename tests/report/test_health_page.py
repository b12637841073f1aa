"""The page about a robot's health: whole, escaped, without script, the same bytes from the same inputs."""

import math
import re
from html.parser import HTMLParser

import pytest

from robophm.core.signal import HOUR, SECOND
from robophm.design.file import parse
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.monitoring.told_past import told_past
from robophm.report.health_page import health_page
from robophm.stores.memory import MemoryStore
from robophm.stores.trend import Trend
from robophm.transports.synthetic import SyntheticOta

DESIGN = """
schema_version: 1
name: <b>OTA & co
task: {distance: 250 m, speed: 0.3 m/s}
modules:
  Drive:
    signals:
      temperature: {topic: /ota/mobility/temperature, field: temperature, range: [-40, 125]}
    components:
      motor: {quantity: 2, rate: 8 FPMH, acceleration: {model: q10}}
      "<script>alert(1)": {rate: 1 FPMH}
"""


class Outline(HTMLParser):
    """Tags that are opened and not closed, attributes that fetch, and the text."""

    VOID = frozenset({"meta", "br", "path", "rect", "circle", "line", "polyline"})

    def __init__(self):
        super().__init__()
        self.tags, self.fetches, self.text = set(), [], ""
        self.open = []

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.fetches += [value for name, value in attrs if name in ("src", "href", "srcset", "action")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


@pytest.fixture(scope="module")
def page():
    robot = parse(DESIGN)
    # An afternoon, a night in which the robot is off, and a morning.
    day = SyntheticOta(seed=3, start=1_709_553_600 * SECOND, duration=20 * HOUR, period=5 * SECOND)
    store = MemoryStore()
    report = replay(robot, day, store=store)
    return robot, report, told_past(store.history(robot.name), report)


def outline(html):
    parsed = Outline()
    parsed.feed(html)
    assert not parsed.open
    return parsed


def test_it_is_whole_and_harmless(page):
    html = health_page(*page)
    found = outline(html)
    assert not found.fetches
    assert "script" not in found.tags
    assert "<b>OTA & co" in found.text
    assert "<script>alert(1)" in found.text
    assert "default-src 'none'" in html


def test_it_says_what_the_report_says(page):
    robot, report, past = page
    text = outline(health_page(robot, report, past)).text
    for part in (
        "Hazard rate now",
        "Reliability",
        "Remaining life",
        "Next task completed",
        "Drive/motor",
        "Assumptions",
    ):
        assert part in text
    assert report.design_hash in text
    bound = text.split("Sensors and data")[1].split("Assumptions")[0]
    cells = (
        "/ota/mobility/temperature.temperature",
        "temperature",
        "Drive/motor",
        "degC",
        "-40 … 125",
        "5 s",
        "conservative",
    )
    assert "".join(cells) in bound.replace("\n", "")
    assert len(past.series.times) > 20


def test_the_short_form_says_what_is_and_not_what_it_follows_from(page):
    robot, report, past = page
    whole, short = (outline(health_page(robot, report, past, short=one)).text for one in (False, True))
    for title in ("Why", "What will fail it", "What to replace first", "What this report is made of"):
        assert title in short
        assert title in whole
    assert "How it is wired" not in short
    assert "What has changed" not in short  # a history of less than a day
    assert len(short) < 0.4 * len(whole)


def test_what_has_changed_as_far_as_it_is_known(page):
    robot, report, past = page
    day = Trend(1_700_000_000 * SECOND, 0.5, -0.0125, -48.0, math.nan)
    text = outline(health_page(robot, report, past._replace(day=day), short=True)).text
    changed = text.split("What has changed")[1].split("What will fail it")[0]
    for words in ("+50 %", "−1.2 % points", "−2 days", "in a day: since 2023-11-14 22:13:20 UTC"):
        assert words in changed
    assert "in a month" not in changed


def test_what_is_breached_passed_and_left_out_stands_in_sections_of_its_own():
    robot = parse("""
schema_version: 1
name: watched
thresholds: {hazard_rate: 1e-4 /h, warning: {hazard_rate: 1e-5 /h}}
components: {motor: {rate: 1e-3 /h}, horn: {rate: unknown}}
""")
    html = health_page(robot, Monitor(robot).report())
    assert "&lt;" not in html
    for title in ("Thresholds breached", "Thresholds of a warning passed", "Parts of unknown rate"):
        assert f"<h2>{title}</h2>" in html
    assert "hazard rate 0.001 /h is above 0.0001 /h" in outline(html).text


def test_the_same_inputs_give_the_same_bytes(page):
    assert health_page(*page) == health_page(*page)


def test_no_line_is_drawn_across_a_night_off(page):
    """Each series as recorded has two pieces, the afternoon and the morning."""
    recorded = health_page(*page).split("<h2>Curves</h2>")[1].split("as recorded")[0]
    courses = re.findall(r'<path[^>]*class="line[^>]*>', recorded)
    drawn = [d for series in courses if "L" in (d := re.search(r' d="([^"]*)"', series)[1])]  # the legend's have none
    assert [d.count("M") for d in drawn] == [2, 2]


def test_without_a_history_the_outlook_is_still_there(page):
    robot, report, _ = page
    text = outline(health_page(robot, report)).text
    assert "Reliability ahead" in text
    assert "as recorded" not in text
