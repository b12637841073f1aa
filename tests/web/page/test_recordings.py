"""Recordings on the page: what they hold, and the course of a signal."""

from __future__ import annotations

from ..test_recordings import VOLTAGE, drive, served

__all__ = ["drive", "served"]  # fixtures


def test_topics_and_the_course_of_a_signal(visit, served):
    look = visit(served)
    page = look.open("reports")
    page.get_by_label("Recording", exact=True).select_option("drive.mcap")
    page.get_by_role("row").filter(has_text="/ota/battery").first.get_by_text("60", exact=True).first.wait_for()
    signal = page.get_by_label("Signal", exact=True)
    signal.fill(VOLTAGE)
    course = page.get_by_role("region", name="Course of a signal")
    course.get_by_text(f"{VOLTAGE} [V]").first.wait_for()
    course.locator("canvas").wait_for()
    signal.fill("/ota/batery.voltage")
    signal.press("Enter")
    course.get_by_role("alert").get_by_text("no topic '/ota/batery'").wait_for()
    assert course.locator("canvas").is_visible()  # what was drawn before stays
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert look.serious() == []
