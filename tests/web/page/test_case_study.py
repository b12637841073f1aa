"""The paper's case study, clicked through from an empty start to a running analysis."""

import time

import pytest
from playwright.sync_api import expect

from robophm.design.file import load

from ..conftest import serving

TABLE_17 = {  # of the paper: modules with some of their parts, quantities and rates of one
    "Mobility": "Encoder\t2\t5.80E-06 /h\nDriver wheel\t2\t1.80E-07 /h\nCaster wheel\t4\t6.80E-06 /h\n"
    "DC Motor\t2\t8.04E-06 /h\nBearing\t4\t3.61E-11 /h",
    "Sensing": "SICK Laser Sensor\t1\t8.00E-08 /h\nCamera\t1\t5.88E-09 /h",
}


@pytest.fixture
def empty(tmp_path):
    with serving(tmp_path / "OTA.yaml", seed=3) as served:
        yield served


@pytest.mark.full
def test_from_nothing_to_a_running_analysis(empty, visit):
    look = visit(empty, accept_downloads=True)
    page = look.open()
    page.get_by_role("button", name="Draw it by hand").click()
    designed(look, page)
    configured(page)
    bound(look, page)
    page.keyboard.press("Control+s")
    page.get_by_text("OTA.yaml, saved").wait_for()
    robot = load(empty.design)
    assert {part.path for part in robot.all_components()} == {
        *(f"{module}/{row.partition(chr(9))[0]}" for module, rows in TABLE_17.items() for row in rows.split("\n")),
        "E-stop",
    }
    assert robot.warnings == ()
    analysed(look, page, empty)
    predicted(look, page)


def designed(look, page):
    """5.1.1 design: modules, then their parts, pasted from the paper's table; one part by a handbook model."""
    for module in TABLE_17:
        page.get_by_role("treeitem", name="OTA").click()
        page.get_by_role("button", name="Add module").click()
        page.get_by_label("Name", exact=True).fill(module)
        page.get_by_role("button", name="Name it so").click()
        page.get_by_role("treeitem", name=module).wait_for()
    look.open("parts")
    for module, rows in TABLE_17.items():
        page.get_by_role("button", name="Paste from a spreadsheet").click()
        page.get_by_label("Into").select_option(module)
        page.get_by_label("Rows").fill(rows)
        page.get_by_role("button", name=f"Add {rows.count(chr(10)) + 1} parts").click()
        page.get_by_role("button", name=f"{module}/{rows.partition(chr(9))[0]}", exact=True).wait_for()

    page.get_by_role("tab", name="Library of models").click()
    page.get_by_label("Find a model").fill("mtbf")
    page.get_by_label("Models", exact=True).select_option("general.mtbf")
    page.get_by_label("mtbf *").fill("2000000")
    page.get_by_label("source *").fill("the maker")
    page.get_by_text("5e-7 /h").wait_for()
    page.get_by_role("button", name="Add to the robot…").click()
    page.get_by_label("Name", exact=True).fill("E-stop")
    page.get_by_role("dialog").get_by_role("button", name="Add", exact=True).click()


def configured(page):
    """5.1.2 configuration: the laser and the camera stand in for each other; acceleration (ALT) of the robot."""
    page.get_by_role("treeitem", name="E-stop").wait_for()
    page.get_by_role("treeitem", name="Sensing").dblclick()
    page.get_by_role("treeitem", name="SICK Laser Sensor").click()
    page.get_by_role("treeitem", name="Camera").click(modifiers=["Control"])
    page.get_by_role("button", name="Group…").click()
    page.get_by_role("button", name="Group", exact=True).click()
    page.locator(".gate", has_text="1/2").wait_for()
    page.get_by_role("treeitem", name="OTA").click()
    page.get_by_label("Acceleration model of the constant-rate parts below").select_option("q10")
    expect(page.get_by_label("Reference temperature")).to_have_value("25 degC")


def bound(look, page):
    """The sensors of two modules."""
    look.open("sensors")
    for module in TABLE_17:
        page.get_by_label("Find a topic").fill(f"/ota/{module.lower()}/temperature")
        page.get_by_role("button", name="temperature [degC]").click()
        page.get_by_label("Of", exact=True).select_option(module)
        page.get_by_label("Lowest that is believed").fill("-40")
        page.get_by_label("Highest that is believed").fill("125")
        page.get_by_role("button", name="Bind", exact=True).click()
        page.get_by_role("button", name=f"Unbind temperature of {module}").wait_for()


def analysed(look, page, empty):
    """5.2: start the analysis; nominal and sensor-based side by side."""
    look.open("live")
    page.get_by_label("Source of sensor data").select_option("synthetic")
    page.get_by_label("Speed").select_option("200")
    page.get_by_role("button", name="Start analysis").click()
    page.get_by_text("Watching").wait_for()
    page.locator(".plot", has_text="Hazard rate").locator("canvas").wait_for()
    page.get_by_text("Sensors in °C").wait_for()
    until = time.monotonic() + 30
    while empty.get("/api/health")["looks"] < 5 and time.monotonic() < until:
        page.wait_for_timeout(100)
    health = empty.get("/api/health")
    mobility = next(one for one in health["subjects"] if one["path"] == "Mobility")
    assert mobility["nominal"]["hazard_rate"] == pytest.approx(
        2 * 5.8e-6 + 2 * 1.8e-7 + 4 * 6.8e-6 + 2 * 8.04e-6 + 4 * 3.61e-11
    )
    assert mobility["sensor_based"]["hazard_rate"] != pytest.approx(mobility["nominal"]["hazard_rate"], rel=1e-3)
    with page.expect_download() as download:
        page.get_by_role("button", name="Hazard rate as CSV, the visible range").click()
    assert download.value.path().read_text().startswith('"time of the samples, UTC",nominal,sensor-based\n')


def predicted(look, page):
    """Tasks: predicted, and again and again."""
    look.open("tasks")
    page.get_by_role("button", name="Add to the list").first.click()
    page.get_by_role("button", name="Predict").click()
    page.get_by_role("columnheader", name="PoTC sensor-based").wait_for()
    page.get_by_label("Times that the list is done").fill("500")
    page.get_by_role("button", name="Start", exact=True).click()
    page.get_by_text("all 500 are completed with").first.wait_for()
    page.get_by_role("button", name="Stop").click()
    page.get_by_role("status").get_by_text("Stopped, not watched", exact=True).wait_for()
