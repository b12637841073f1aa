"""Maintenance on the page: what decides, what is replaced first and when, a service while the robot is watched."""

from __future__ import annotations

import pytest

from ..conftest import serving
from ..test_maintenance import CART, watched

COSTS = "part,preventive,corrective\ndrive/motor,10,100\ndrive/brake,5,50\n"


@pytest.fixture
def cart(tmp_path):
    path = tmp_path / "cart.yaml"
    path.write_text(CART + "usage: {operating: 50 %}\n")
    return path


@pytest.mark.full
def test_what_decides_and_what_is_replaced_first_in_two_clicks(cart, visit, monkeypatch):
    with watched(cart, monkeypatch) as served:
        look = visit(served)
        page = look.open("overview")
        page.locator(".answer summary").filter(has_text="drive/motor").wait_for()  # which part decides: no click
        page.get_by_role("link", name="Maintenance").click()  # what to replace first, and when: one
        page.get_by_text("Replace drive/motor first, within").wait_for()
        page.get_by_text("it wears out: it has aged").first.wait_for()
        assert look.serious() == []

        page.get_by_role("button", name="Note a service of drive/motor").click()
        assert look.serious() == []
        page.get_by_label("What was done").select_option("repaired")
        page.get_by_label("Share of its age that remains, %").fill("120")
        assert page.get_by_role("button", name="Note it").is_disabled()
        page.get_by_label("What was done").select_option("replaced")
        page.get_by_label("By").fill("Ada")
        page.get_by_label("Note", exact=True).fill("was noisy")
        page.get_by_role("button", name="Note it").click()
        done = page.get_by_role("region", name="Services so far")
        done.get_by_text("was noisy").wait_for()
        (kept,) = served.get("/api/maintenance")["services"]
        assert (kept["mode"], kept["kind"], kept["by"], kept["note"]) == ("drive/motor", "replaced", "Ada", "was noisy")

        page.get_by_text("Costs of parts").wait_for()
        page.get_by_label("Table of costs").fill(COSTS)
        page.get_by_role("button", name="Keep costs").click()
        page.get_by_text("Today: only what fails").wait_for()
        page.get_by_text("Best plan: by age").wait_for()
        with page.expect_download() as coming:
            page.evaluate("document.querySelector('a[href*=\".ics\"]').setAttribute('download', '')")
            page.get_by_role("link", name="Calendar (iCal)").click()
        assert b"BEGIN:VCALENDAR" in coming.value.path().read_bytes()


@pytest.mark.full
def test_without_a_past_nothing_can_be_noted_and_it_is_said(cart, visit):
    cart.write_text(CART.replace("        life: {distribution: weibull, shape: 3}\n", ""))
    with serving(cart, store=f"{cart}.past", own_store=True) as served:
        look = visit(served)
        page = look.open("maintenance")
        page.get_by_text("No part is due by age: none that has a rate wears out.").wait_for()
        page.get_by_text("Nothing has been watched yet").wait_for()
        page.get_by_text("2 parts do not wear").wait_for()
        assert page.get_by_role("button", name="Note a service of drive/motor").is_disabled()
        assert look.serious() == []
