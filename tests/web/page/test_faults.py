"""Failure modes, field data and comparisons on the page, each by a file that is chosen."""

from __future__ import annotations

from ..conftest import SMALL
from ..test_fault_trees import BRIDGE, courier
from ..test_faults import LOG, SENSORS


def test_failure_modes_and_what_alarms_mean(visit, shared_small, tmp_path):
    (tmp_path / "sensors.csv").write_text(SENSORS)
    look = visit(shared_small)
    page = look.open("analysis")
    page.get_by_role("tab", name="Failure modes").click()
    page.get_by_role("rowheader").first.wait_for()
    page.get_by_role("row").filter(has_text="drive/motor").first.get_by_text("the robot fails").wait_for()
    page.locator("input[type=file]").set_input_files(tmp_path / "sensors.csv")
    page.get_by_label("vibration").check()
    page.get_by_role("heading", name="Suspects, vibration being on and all others off").wait_for()
    assert look.serious() == []


def test_field_data_and_another_design(visit, shared_small, tmp_path):
    (tmp_path / "log.csv").write_text(LOG)
    (tmp_path / "other.yaml").write_text(SMALL.replace("30 FPMH", "300 FPMH"))
    look = visit(shared_small)
    page = look.open("analysis")
    page.get_by_role("tab", name="Field data").click()
    page.locator("input[type=file]").first.set_input_files(tmp_path / "log.csv")
    page.get_by_role("row").filter(has_text="drive/motor").get_by_text("0.104").wait_for()
    page.get_by_label("What changes in the design").get_by_text("learned: {factor:").first.wait_for()
    page.get_by_role("button", name="Use these rates").click()
    page.get_by_text("The design has these rates.").wait_for()
    page.get_by_role("button", name="Undo", exact=True).click()
    page.get_by_role("button", name="Use these rates").wait_for()
    assert look.serious() == []
    page.get_by_role("tab", name="Compare").click()
    page.get_by_text("Met: it fails within 1,000 h of operation with").wait_for()
    page.locator("input[type=file]").set_input_files(tmp_path / "other.yaml")
    page.get_by_role("row").filter(has_text="see/lidar").wait_for()
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert look.serious() == []


def test_the_fault_tree_of_the_design_and_of_a_file(visit, shared_small, tmp_path):
    (tmp_path / "bridge.xml").write_text(BRIDGE)
    (tmp_path / "torn.xml").write_text("<opsa-mef>")
    look = visit(shared_small)
    page = look.open("analysis")
    page.get_by_role("tab", name="Fault tree").click()
    page.get_by_label("After [h of operation of a new robot]").fill("2000")
    page.get_by_text(f"occurs with {courier(2000):.6g} (exact)").wait_for()
    page.get_by_role("list", name="Fault tree of the design").get_by_text("see/lidar").wait_for()
    with page.expect_download() as download:
        page.get_by_role("button", name="Download as Open-PSA model").click()
    page.locator("input[type=file]").set_input_files(download.value.path())  # its name has no suffix that it is read by
    page.get_by_text("expected an Open-PSA model").wait_for()
    page.locator("input[type=file]").set_input_files(tmp_path / "bridge.xml")
    page.get_by_label("Mission time [h]").fill("100")
    page.get_by_text("top, at 100 h: occurs with").wait_for()
    page.get_by_label("Mission time [h]").fill("-100")
    page.get_by_text("expected a number above 0").wait_for()
    assert page.get_by_text("top, at 100 h: occurs with").is_visible()
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert look.serious() == []
