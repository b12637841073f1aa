"""The history on the page: from years to hours, events, the robot's report as it was."""

from __future__ import annotations

import re
import time
from datetime import UTC, datetime, timedelta

import pytest

import robophm
from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.monitoring.replay import replay
from robophm.report.why import reasons
from robophm.stores import open_store

from ..conftest import SMALL, serving
from ..test_history import BEGIN, fill
from ..test_honesty import fill as promised_and_noted


@pytest.fixture(scope="module")
def lived(tmp_path_factory):
    """The courier after 400 days, six reports a day."""
    folder = tmp_path_factory.mktemp("lived")
    design = folder / "courier.yaml"
    design.write_text(SMALL)
    fill(design, folder / "past.db", every=4)
    with serving(design, seed=1, store=folder / "past.db") as served:
        yield served


@pytest.mark.full
def test_from_a_year_to_a_day_to_the_report_of_then(visit, lived):
    look = visit(lived)
    page = look.open("history")
    page.get_by_text("each point").wait_for()
    for title in ("Hazard rate", "Probability of having failed since new", "Remaining life", "State"):
        page.get_by_role("region", name=title, exact=True).wait_for()
    page.get_by_role("row").filter(has_text="hazard rate 2 /h is above 1 /h").first.wait_for()
    assert look.serious() == []
    # The breach, from the list of events.
    page.get_by_role("row").filter(has_text="breach ended").get_by_role("button").click()
    as_it_was = page.get_by_role("region", name="The robot as it was")
    as_it_was.get_by_text("State: ok").wait_for()
    page.get_by_role("row").filter(has_text="breach").last.get_by_role("button").click()
    as_it_was.get_by_text("State: error").wait_for()
    # A day, then a drag across a plot.
    page.get_by_role("button", name="1 week").click()
    page.get_by_text("each point one report").wait_for()
    plot = page.get_by_role("region", name="Hazard rate", exact=True).locator(".u-over")
    box = plot.bounding_box()
    page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.75 * box["width"], box["y"] + 50, steps=4)
    with page.expect_response(lambda answer: "/api/history?" in answer.url) as told:
        page.mouse.up()
    between = [float(one) for one in re.findall(r"=(\d+\.?\d*)", told.value.url)[:2]]
    week = BEGIN / SECOND + 196.5 * 86_400, BEGIN / SECOND + 203.5 * 86_400
    assert week[0] < between[0] < between[1] < week[1]
    # A click is a moment, shown by the slider and the report.
    words = page.get_by_label("Look at").get_attribute("aria-valuetext")
    plot = page.get_by_role("region", name="Hazard rate", exact=True).locator(".u-over")
    with page.expect_response(lambda answer: "/api/history/report" in answer.url):
        plot.click(position={"x": 40, "y": 60})
    assert page.get_by_label("Look at").get_attribute("aria-valuetext") != words
    page.get_by_role("button", name="All", exact=True).click()
    page.get_by_text("each point 24 h").wait_for()
    assert look.wrong == []


HOT = SMALL.replace(
    "motor: {quantity: 2, rate: 8 FPMH}",
    "motor: {quantity: 2, rate: 8 FPMH, signals: {temperature: {topic: /casters, field: t, unit: degC}}}",
)


@pytest.mark.full
def test_since_when_a_stress_is_beyond_its_design_and_its_course_beside_the_figures(visit, tmp_path):
    """Four hours at 20 °C, then at 40 °C, designed for 25 °C; a report every ten minutes."""
    design, begin = tmp_path / "courier.yaml", BEGIN // SECOND
    design.write_text(HOT)
    rows = [f"{begin + 5 * i},{20 if i < 2880 else 40}" for i in range(5760)]
    (tmp_path / "drive.csv").write_text("time,/casters.t\n" + "\n".join(rows) + "\n")
    with open_store(tmp_path / "past.db") as store:
        replay(load(design), tmp_path / "drive.csv", store=store, report_every=600)
    after, since = (datetime.fromtimestamp(begin + 4 * 3600 + one, UTC) for one in (0, 600))
    said = f"above that since {since:%Y-%m-%d %H:%M:%S} UTC, not yet at {after:%Y-%m-%d %H:%M:%S} UTC"
    with serving(design, seed=1, store=tmp_path / "past.db") as served:
        look = visit(served)
        page = look.open("overview")
        page.locator("details.answer summary").click()
        page.get_by_text(said).wait_for()
        page.get_by_role("link", name="History").click()
        signal = page.get_by_role("region", name="Signal", exact=True)
        signal.get_by_text("/casters.t [°C]").first.wait_for()
        assert look.serious() == []
    assert said in " ".join(reasons(robophm.why(design, tmp_path / "past.db")))


def test_cards_tell_what_has_changed_up_to_now_and_draw_no_line_where_nothing_was_known(visit, tmp_path):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    fill(design, tmp_path / "past.db", time.time_ns() - 40 * 3600 * SECOND, 41, off=range(25, 31))
    with serving(design, seed=1, store=tmp_path / "past.db") as courier:
        look, asked = visit(courier), list[str]()
        look.page.on("request", lambda request: asked.append(request.url))
        page = look.open("overview")
        card = page.locator(".figure", has_text="Hazard rate")
        card.get_by_text("since yesterday").wait_for()
        card.get_by_text("↑ 150 %").wait_for()  # 16 by then, 40 now
        assert page.get_by_text("since last month").count() == 0
        page.locator(".figure", has_text="Remaining life").get_by_text("unchanged").wait_for()
        course = card.get_by_role("img", name="Over 24 h between 16 /h and 40 /h")
        assert course.locator("path").get_attribute("d").count("M") == 2
        assert page.locator(".sparkline").count() == 4
        assert look.serious() == []
        look.open("history").get_by_text("each point").wait_for()
        look.open("overview").get_by_text("since yesterday").first.wait_for()
        assert sum("/api/history/trends" in url for url in asked) == 1


def test_cards_of_a_past_that_is_over_do_not_speak_of_yesterday(visit, lived):
    page = visit(lived).open("overview")
    card = page.locator(".figure", has_text="Hazard rate")
    card.get_by_text("in its last day").wait_for()
    card.get_by_text("↑ 0.25 %").wait_for()
    card.get_by_text("in its last month").wait_for()
    card.get_by_text("↑ 8.1 %").wait_for()
    assert page.get_by_text("since yesterday").count() == 0


def test_whether_it_was_honest_is_one_click_from_the_overview(visit, tmp_path):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    promised_and_noted(design, tmp_path / "past.db")
    with serving(design, seed=1, store=tmp_path / "past.db") as served:
        look = visit(served)
        page = look.open("overview")
        page.get_by_role("link", name="History").click()
        card = page.get_by_role("region", name="Was it honest?")
        card.get_by_text("Nothing speaks against what was promised: 3 promised, 4 noted").wait_for()
        card.get_by_text("Nothing speaks against what was promised: 1.8 promised, 1 noted").wait_for()
        card.get_by_text("; 1 of others are not counted").wait_for()
        assert look.serious() == []


@pytest.mark.full
def test_moments_are_local_where_that_is_wished(visit, lived):
    """Kolkata is 5 h 30 min ahead of UTC, all year; marks of an axis stand at its hours."""
    look = visit(lived, timezone_id="Asia/Kolkata")
    page = look.open("settings")
    page.get_by_label("Dates and times").select_option("local")
    page = look.open("history")
    begin = min(one["time"] for one in lived.get("/api/history")["events"] if one["kind"] == "breach")
    said = datetime.fromtimestamp(begin, UTC) + timedelta(hours=5, minutes=30)
    page.get_by_role("button", name=f"{said:%Y-%m-%d %H:%M:%S} UTC+5:30").first.wait_for()
    page.get_by_role("button", name="1 day").click()
    page.get_by_text("each point one report").wait_for()
    with page.expect_download() as download:
        page.get_by_role("button", name="Hazard rate as SVG").click()
    picture = download.value.path().read_text()
    assert "time, UTC+5:30" in picture
    marks = re.findall(r">(\d\d:\d\d)</text>", picture)
    assert len(marks) >= 2
    assert {mark[3:] for mark in marks} == {"00"}
