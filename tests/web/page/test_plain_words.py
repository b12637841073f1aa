"""What was stopped is not called well, what an import assumed is shown, and rounding is no advice."""

from __future__ import annotations

import re

import pytest

from ..conftest import SMALL, serving

WATCHED = SMALL.replace("    diagram: {parallel: [lidar, camera]}\n", "").replace(
    "{quantity: 2, rate: 8 FPMH}",
    "{quantity: 2, rate: 8 FPMH, signals: {temperature: {topic: /motor, field: temperature, unit: degC}}}",
)
BOARD = """\
Reference,Value,Footprint,Qty
R1 R2,10k,R_0603_1608Metric,2
X9,thing,,1
"""


@pytest.fixture(scope="module")
def courier(tmp_path_factory):
    """A courier with a limit, and an hour of its motor's temperature."""
    folder = tmp_path_factory.mktemp("courier")
    design, table = folder / "courier.yaml", folder / "drive.csv"
    design.write_text(f"{WATCHED}thresholds: {{reliability: 0.5}}\n")
    table.write_text("time,/motor.temperature\n" + "".join(f"{1_700_000_000 + t},25\n" for t in range(3600)))
    with serving(design, recordings=(table,)) as served:
        yield served


@pytest.mark.full
def test_what_was_stopped_is_not_called_well(courier, visit):
    courier.post("/api/monitoring/start", {"source": "recordings", "speed": 1})
    look = visit(courier)
    page = look.open("overview")
    well = page.get_by_role("link", name="Health: OK")
    well.wait_for()
    assert page.locator("main .state.ok").count() > 0
    page.get_by_role("button", name="Stop").click()
    well.wait_for(state="detached")
    page.get_by_role("banner").get_by_role("status").get_by_text("Stopped, not watched").wait_for()
    assert page.title() == "STOPPED – Overview – courier"
    icon = page.locator("link[rel=icon]").get_attribute("href")
    assert icon == "./icon-stopped.svg"
    assert courier.client.get(icon).headers["content-type"].startswith("image/svg")
    page.get_by_role("button", name="Start analysis").wait_for()
    assert page.locator(".state.ok").count() == 0
    assert courier.get("/api/health")["state"] == "idle"
    assert look.wrong == []


def test_what_an_import_assumes_is_shown_before_it_is_made(courier, visit, tmp_path):
    (tmp_path / "board.csv").write_text(BOARD)
    look = visit(courier)
    page = look.open("parts/import")
    page.get_by_label("Choose a parts list").set_input_files(str(tmp_path / "board.csv"))
    row = page.get_by_role("row", name="R1, R2")
    row.get_by_text("power 0.05 W, rated power 0.1 W, temperature 40 degC").wait_for()  # half the load of a 0603
    page.get_by_role("row", name="X9").get_by_text("to be rated by hand").wait_for()
    assert look.serious() == []
    assert courier.get("/api/design")["undo"] is None  # nothing is changed


def test_rounding_is_no_advice(courier):
    """Parts of constant rates are as good as new: to replace one gains nothing, and no 1.7e-15 h either."""
    report = courier.client.get("/api/report").text
    assert "Nothing gains by being replaced" in report
    assert not re.search(r"[+−-]\s?\d(\.\d+)?e-1\d", report)


def test_a_share_that_is_a_bit_below_one_is_not_called_all(tmp_path, visit):
    design = tmp_path / "two.yaml"
    design.write_text("schema_version: 1\nname: two\ncomponents: {motor: {rate: 8 FPMH}, lamp: {rate: 8e-5 FPMH}}\n")
    with serving(design) as two:
        page = visit(two).open("analysis")
        page.get_by_role("tab", name="What matters most").click()
        row = page.get_by_role("region", name="Importances").get_by_role("row", name="motor")
        row.wait_for()
        assert row.get_by_role("cell").all_text_contents()[-1] == "99.999 %"


@pytest.mark.full
def test_rates_as_one_in_so_many_hours(shared_small, visit):
    """Two motors at 8 FPMH and an encoder at 2: one in 55,560 h."""
    page = visit(shared_small).open("settings")
    page.get_by_label("Hazard rates in").select_option("MTBF")
    page.get_by_role("link", name="Overview").click()
    page.get_by_role("row", name="drive").get_by_text("1 in 55,560 h").first.wait_for()
    page.get_by_role("link", name="Design").click()
    page.locator(".box", has_text="drive").get_by_text("1 in 55,560 h").wait_for()
    page.get_by_role("link", name="Analysis").click()
    page.get_by_role("region", name="Hazard rate of survivors").get_by_text("λ = f/R [1/h]").first.wait_for()
