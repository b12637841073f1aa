"""The history on the page: from years to hours, events, the robot's report as it was."""

from __future__ import annotations

import re

from robophm.core.signal import SECOND

from ..test_history import BEGIN, lived

__all__ = ["lived"]


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
