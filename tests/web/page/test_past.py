"""Stop and start on the page keep the past, and the page says before what becomes of it."""

from __future__ import annotations

import pytest

from robophm.core.signal import SECOND
from robophm.web.service import Service

from ..test_past import CART, beside, drive, hours, live, until
from ..test_past import ages as ages_of


@pytest.mark.full
def test_a_part_renamed_on_the_page_goes_on_after_stop_and_start(visit, tmp_path):
    design = tmp_path / "cart.yaml"
    design.write_text(CART)
    with beside(design, recordings=(drive(tmp_path / "drive", 0),)) as cart:
        page = visit(cart).open("overview")
        page.get_by_label("Speed").select_option("200")
        page.get_by_role("button", name="Start analysis").click()
        run = cart.service.monitoring
        until(lambda: run.run and run.run.ledger and (run.run.ledger.newest or 0) > 1_795_000_620 * SECOND)
        page.get_by_role("button", name="Stop").click()
        page.get_by_role("button", name="Start analysis").wait_for()
        before = ages_of(cart)
        assert before["lamp"] > 0.1
        page.goto(f"{cart.address}#/design/lamp")
        page.get_by_role("treeitem", name="lamp").click()
        page.keyboard.press("F2")
        page.get_by_role("textbox").last.fill("beam")
        page.get_by_role("button", name="Name it so").click()
        page.get_by_role("button", name="What becomes of the past: 1 changed").click()
        page.get_by_role("row", name="beam goes on; was lamp").wait_for()
        page.get_by_role("button", name="Close").click()
        assert ages_of(cart)["beam"] == before["lamp"]
        page.goto(f"{cart.address}#/overview")
        page.get_by_role("button", name="Start analysis").click()
        until(lambda: ages_of(cart)["beam"] > before["lamp"] + 0.05)
        assert page.get_by_role("button", name="What becomes of the past").count() == 0


@pytest.mark.full
def test_what_a_hand_edit_leaves_open_is_answered_in_a_dialog(visit, tmp_path, monkeypatch):
    design = tmp_path / "cart.yaml"
    design.write_text(CART)
    with beside(design) as cart:
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "first", 0))})
        cart.post("/api/monitoring/start", {"source": "live"})
        until(lambda: cart.get("/api/monitoring")["state"] != "running")
    design.write_text(CART.replace("brake", "clutch"))
    with beside(design) as cart:
        look = visit(cart)
        page = look.open("overview")
        page.get_by_role("alert").get_by_text("'drive/clutch' has no past, and 'drive/brake' has one").wait_for()
        page.get_by_role("button", name="What becomes of the past: 1 to answer").click()
        choice = page.get_by_label("Which part drive/clutch is")
        assert choice.locator("option").all_inner_texts() == ["it is drive/brake", "it is new"]
        assert look.serious() == []
        page.get_by_role("button", name="Answer", exact=True).click()
        page.get_by_role("button", name="What becomes of the past: 1 changed").wait_for()
        assert ages_of(cart) == hours(drive_motor=1, drive_clutch=1, lamp=1)
