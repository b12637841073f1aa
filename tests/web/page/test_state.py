"""What the header and the overview say of health, what will fail the robot, and saving over a file changed by hand."""

from __future__ import annotations

import math
import re
import time

import pytest

from robophm.core.signal import SECOND
from robophm.health.worn import moment

from ..conftest import OTA, ROOT, SMALL, serving
from ..test_service import works

HORN = {"op": "put", "path": ["components", "horn"], "value": {"rate": "1 FPMH"}}


@pytest.fixture
def served(tmp_path):
    """A service of any text."""

    def begin(text, **settings):
        design = tmp_path / "courier.yaml"
        design.write_text(text)
        return serving(design, seed=1, **settings)

    return begin


def test_a_breached_threshold_is_never_beside_a_green_word(served, visit):
    with served(f"{SMALL}thresholds: {{hazard_rate: 1e-9 /h}}\n") as courier:
        assert courier.get("/api/health")["state"] == "error"
        look = visit(courier)
        page = look.open("design")
        page.get_by_role("link", name="Health: error").wait_for()
        assert page.locator("header .state.ok").count() == 0
        page.get_by_role("button", name="Problems of the design: No problems").wait_for()
        page.get_by_role("link", name="Health: error").click()
        page.get_by_text("hazard rate 1.8e-05 /h is above 1e-09 /h").wait_for()
        assert look.serious() == []


def test_where_no_limit_is_set_nothing_is_called_well(served, visit):
    with served(SMALL) as courier:
        assert courier.get("/api/health")["limits_set"] is False
        page = visit(courier).open("overview")
        page.get_by_text("no thresholds are set: nothing is called too low").wait_for()
        assert page.locator("header .state.ok, main .state.ok").count() == 0
    with served(f"{SMALL}thresholds: {{warning: {{reliability: 0.5}}}}\n") as courier:
        assert courier.get("/api/health")["limits_set"] is True


def test_the_worst_contributors_are_those_of_the_failures_to_come(visit, tmp_path):
    """The arm's encoders have the highest rates, and one of each two is enough; its controller fails it."""
    design = tmp_path / "robot.yaml"
    design.write_bytes((ROOT / "examples" / "arm" / "robot.yaml").read_bytes())
    with serving(design, seed=1) as arm:
        found = arm.get("/api/health")["to_come"]
        assert found["parts"][0]["path"] == "Control/Controller"
        assert not any("Encoder" in part["path"] for part in found["parts"])
        soon = arm.get("/api/health", horizon=24)["to_come"]
        assert (soon["horizon"], soon["stated"]) == (24, True)
        page = visit(arm).open("overview")
        bars = page.get_by_role("list", name="Share of the failures")
        bars.get_by_role("link").first.wait_for()
        assert bars.get_by_role("link").first.text_content().startswith("Control/Controller")
        page.get_by_text("the median remaining life, that a part brings about").wait_for()
        page.get_by_label("within", exact=True).select_option("24")
        page.get_by_text("Share of the failures within 24 h that a part brings about").wait_for()
        bars.get_by_role("link").first.click()
        page.get_by_role("heading", name="Controller").wait_for()
        page.get_by_text(re.compile(r"mean life .* years, median .* years")).wait_for()


def test_parts_of_unknown_rate_mark_what_they_are_in_and_nothing_else(served, visit):
    text = SMALL.replace("encoder: {rate: 2 FPMH}", "encoder: {rate: unknown}")
    with served(text) as courier:
        said = courier.get("/api/health")
        assert [(one["path"], one["unknown"] is not None) for one in said["subjects"]] == [
            ("", True), ("drive", True), ("see", False),
        ]  # fmt: skip
        assert said["state"] == "warn"
        look = visit(courier)
        page = look.open("overview")
        page.get_by_text("1 part of unknown rate is left out of the totals: λ is at least").wait_for()
        page.get_by_text(re.compile("it fails within that time with ≥ [0-9]")).wait_for()
        page.get_by_role("row", name="drive").get_by_text("≥ 1.6e-5 /h").first.wait_for()
        assert "≥" not in page.get_by_role("row", name="see").text_content()
        page.get_by_role("button", name="Problems of the design: 1 odd").wait_for()
        page = look.open("design/drive/encoder")
        page.get_by_text("mean life unknown, median unknown").wait_for()
        page = look.open("analysis")
        page.get_by_text("1 part of unknown rate is left out of the totals").first.wait_for()
        page.get_by_role("tab", name="What matters most").click()
        page.get_by_text(re.compile("It fails within that time with ≥ [0-9]")).wait_for()


@pytest.mark.full
def test_importances_that_are_infinite_are_not_those_that_do_not_apply(served, visit):
    lone = "schema_version: 1\nname: lone\ncomponents: {motor: {rate: 8 FPMH}}\n"
    for text, raw, rrw in ((lone, "[0-9,.]+", "∞"), (lone.replace("8 FPMH", "unknown"), "∞", "–")):
        with served(text) as robot:
            look = visit(robot)
            page = look.open("analysis")
            page.get_by_role("tab", name="What matters most").click()
            row = page.get_by_role("region", name="Importances").get_by_role("row", name="motor")
            row.wait_for()
            cells = row.get_by_role("cell").all_text_contents()
            assert re.fullmatch(raw, cells[3])
            assert cells[4] == rrw
    page.get_by_text("1 part of unknown rate is left out of the totals: what is not said to be").wait_for()


@pytest.mark.full
def test_tasks_are_marked_where_parts_of_unknown_rate_are_left_out(visit, tmp_path):
    """The OTA is a series of its parts: what it leaves out can only fail more tasks."""
    design = tmp_path / "robot.yaml"
    design.write_text(OTA.read_text(encoding="utf-8").replace("rate: 5e-06 /h", "rate: unknown", 1))
    with serving(design, seed=3) as ota:
        ota.post("/api/monitoring/start", {"source": "synthetic", "speed": 1000})
        until = time.monotonic() + 60
        done = []
        while not done and time.monotonic() < until:
            time.sleep(0.2)
            done = [one for one in ota.get("/api/tasks/arrived")["tasks"] if one["actual"]]
        assert done[0]["actual"]["unknown"]["parts"] == 9
        page = visit(ota).open("tasks")
        page.get_by_text("9 parts of unknown rate are left out of the totals: every PoTC is at most").first.wait_for()
        row = page.get_by_role("region", name="Arrived tasks").get_by_role("row").last
        assert re.search(r"≤ \d.*nominal ≤ \d.*≤ \d.*nominal ≤ \d", row.text_content())
        page.get_by_role("button", name="Predict").click()
        answer = page.get_by_role("region", name="Answer").get_by_role("row").last
        answer.wait_for()
        assert answer.text_content().count("≤ ") == 2


def test_saving_does_not_write_over_a_hand_edit(served, visit):
    with served(SMALL) as courier:
        look = visit(courier)
        page = look.open("design")
        courier.edit(HORN)
        page.get_by_text("courier.yaml, not saved").wait_for()
        by_hand = SMALL.replace("quantity: 2", "quantity: 4")
        courier.design.write_text(by_hand)
        page.keyboard.press("Control+s")
        dialog = page.get_by_role("dialog")
        dialog.get_by_text("courier.yaml was changed outside since it was read").wait_for()
        dialog.get_by_text("+      motor: {quantity: 4, rate: 8 FPMH}").wait_for()
        assert look.serious() == []
        dialog.get_by_role("button", name="Cancel").click()
        assert courier.design.read_text() == by_hand
        page.keyboard.press("Control+s")
        dialog.get_by_role("button", name="Overwrite the file").click()
        page.get_by_text("courier.yaml, saved").wait_for()
        assert "horn" in courier.design.read_text()
        assert courier.design.with_name("courier.yaml.bak").read_text() == by_hand


def test_a_hand_edit_is_taken_and_undone(served, visit):
    with served(SMALL) as courier:
        page = visit(courier).open("design")
        courier.edit(HORN)
        page.get_by_text("courier.yaml, not saved").wait_for()
        courier.design.write_text(SMALL.replace("name: courier", "name: express"))
        page.keyboard.press("Control+s")
        page.get_by_role("button", name="Reload the file").click()
        page.get_by_text("courier.yaml, saved").wait_for()
        assert courier.get("/api/design")["name"] == "express"
        page.get_by_role("button", name="Undo").last.click()
        page.get_by_text("courier.yaml, not saved").wait_for()
        assert "horn" in courier.get("/api/design")["document"]["components"]


NIGHT = """\
schema_version: 1
name: night shift
components:
  motor:
    rate: 8 FPMH
    acceleration: {model: q10, reference_temperature: 25 degC}
    signals: {temperature: {topic: /motor, field: temperature, unit: degC, max_age: 30 s}}
  fan:
    rate: 8 FPMH
    acceleration: {model: q10, reference_temperature: 25 degC}
    signals: {temperature: {topic: /fan, field: temperature, unit: degC, max_age: 30 s}}
"""


@pytest.mark.full
def test_silences_are_those_that_were_heard_and_lines_do_not_cross_a_night(tmp_path, visit):
    """Two hours, a night, an hour in which the fan's sensor dies; in every window, however few points are drawn."""
    design, table = tmp_path / "robot.yaml", tmp_path / "drive.csv"
    design.write_text(NIGHT)
    begin, night, hour, every = 1_700_000_000, 9 * 3600, 3600, 20
    rows = [f"{begin + t},{30 + t % 7},{35 + t % 5}" for t in range(0, 2 * hour, every)]
    rows += [f"{begin + 2 * hour + night + t},{30 + t % 7},{35 if t < 600 else ''}" for t in range(0, hour, every)]
    table.write_text("\n".join(["time,/motor.temperature,/fan.temperature", *rows]) + "\n")
    off, on = begin + 2 * hour - every, begin + 2 * hour + night
    with serving(design, recordings=(table,)) as served:
        served.post("/api/monitoring/start", {"source": "recordings", "speed": 10_000})
        look = visit(served)
        page = look.open("live")
        page.get_by_text("Recording over").wait_for()
        board = served.service.monitoring.board
        assert board.gaps("/motor.temperature") == [(off + 30, on)]
        died = on + 600 - every
        assert board.gaps("/fan.temperature") == [(off + 30, on), (died + 30, None)]
        assert board.gaps("reliability.nominal:") == [(off + 60, on)]
        # of all there is: the night, then the hour's rest without the fan; in eight hours, of which the night has the
        # first seven, and in one, that rest alone
        dead = hour - 600 - 30
        truths = {"100000": (night - 30 + dead) / (3 * hour + night), "28800": dead / hour, "3600": dead / hour}
        for window, truth in truths.items():
            page.get_by_label("Window").select_option(window)
            plot = page.get_by_role("region", name="Sensors in °C")
            until, share = time.monotonic() + 60, None
            while share != pytest.approx(truth, abs=0.02) and time.monotonic() < until:
                page.wait_for_timeout(100)
                share = plot.locator("canvas").evaluate(SHADED)
            assert share == pytest.approx(truth, abs=0.02), window
        # the fan was at 35 °C, ten above its reference, when its sensor died: it stays twice as fast as designed
        says = f"rests on silence since {moment(died * SECOND)} of /fan.temperature"
        hot = 8e-6 * 2 + 8e-6 * 2 ** ((30 + (hour - every) % 7 - 25) / 10)
        found = served.get("/api/health")
        assert found["subjects"][0]["sensor_based"]["hazard_rate"] == pytest.approx(hot, rel=1e-12)
        assert (found["state"], found["why"]) == ("stale", ["stale /fan.temperature", says])
        assert says in served.client.get("/api/report").text
        page = look.open("overview")
        page.locator("main .state", has_text="STALE").first.wait_for()
        page.locator(".trouble").get_by_text(says).wait_for()
        page.locator(".figure", has_text="Hazard rate").get_by_text(f"{hot:.3e}".replace("e-0", "e-")).wait_for()
        assert look.wrong == []


def test_one_sentence_says_how_long_it_works_on_and_what_decides(served, visit):
    """The lidar's and the camera's rates are higher, but one of them is enough."""
    with served(SMALL) as courier:
        look = visit(courier)
        page = look.open("overview")
        rate = 2 * 8e-6 + 2e-6
        said = courier.get("/api/health")["sentence"]
        assert said.startswith("Works on for ")
        assert "drive/motor comes first" in said
        page.get_by_text(said).click()
        page.get_by_text("drive/motor ×2 (").wait_for()
        (days,) = re.findall(r"Works on for ([\d.]+) days with 90 %", said)
        assert float(days) * 24 < 0.105361 / rate
        assert look.wrong == []
        assert look.serious() == []


SHADED = """
canvas => {
  const ratio = devicePixelRatio, left = Math.ceil(76 * ratio), right = canvas.width - Math.ceil(26 * ratio);
  const row = canvas.getContext("2d").getImageData(left, Math.round(21 * ratio), right - left, 1).data;
  return row.filter((_, i) => i % 4 === 3).filter((alpha) => alpha > 0 && alpha < 255).length / (right - left);
}
"""
"""The share of a plot's width that is shaded, seen above its curves, which are opaque."""


@pytest.mark.full
def test_an_address_that_is_no_encoded_text_opens_its_page(served, visit):
    with served(SMALL) as courier:
        look = visit(courier)
        page = look.page
        page.goto(f"{courier.address}#/design/50%")
        page.get_by_role("treeitem", name="courier").wait_for()
        assert look.wrong == []


def wait_for_title(page, title):
    until = time.monotonic() + 60
    while page.title() != title and time.monotonic() < until:
        page.wait_for_timeout(50)
    assert page.title() == title


def test_what_is_not_well_is_seen_in_the_tab(served, visit):
    with served(f"{SMALL}thresholds: {{hazard_rate: 1e-9 /h}}\n") as courier:
        page = visit(courier).open("design")
        wait_for_title(page, "ERROR – Design – courier")
        icon = page.locator("link[rel=icon]").get_attribute("href")
        assert courier.client.get(icon).headers["content-type"].startswith("image/svg")
        courier.edit({"op": "put", "path": ["thresholds", "hazard_rate"], "value": "1 /h"})
        wait_for_title(page, "Design – courier")


@pytest.mark.full
def test_a_plot_is_taken_along_with_what_it_says(tmp_path, visit):
    """Its moments as dates; its picture with ground, title and legend."""
    design, table = tmp_path / "robot.yaml", tmp_path / "drive.csv"
    span = 599 * 2 / 3600  # hours, after which R is 1 − 1/7400 where 1 − 1/7900 was designed
    motor = NIGHT.partition("  fan:")[0].replace("8 FPMH", f"{-math.log1p(-1 / 7900) / span} /h")
    design.write_text(motor)
    degrees = 25 + 10 * math.log2(math.log1p(-1 / 7400) / math.log1p(-1 / 7900))
    table.write_text("time,/motor.temperature\n" + "".join(f"{1_700_000_000 + 2 * t},{degrees}\n" for t in range(600)))
    with serving(design, recordings=(table,)) as served:
        served.post("/api/monitoring/start", {"source": "recordings", "speed": 10_000})
        look = visit(served)
        page = look.open("live")
        page.get_by_text("Recording over").wait_for()
        wait_for_title(page, f"RECORDING OVER – Live – {served.get('/api/design')['name']}")
        assert page.locator("link[rel=icon]").get_attribute("href") == "./icon-stopped.svg"
        page.get_by_label("Window").select_option("3600")

        def taken(kind):
            with page.expect_download() as download:
                page.get_by_role("button", name=f"Sensors in °C as {kind}").click()
            return download.value.path().read_bytes()

        until, rows = time.monotonic() + 60, []
        while len(rows) <= 600 and time.monotonic() < until:  # the window of ten minutes may still be shown
            page.wait_for_timeout(100)
            rows = taken("CSV").decode().splitlines()
        assert rows[1].startswith(f"2023-11-14T22:13:20.000Z,{degrees:.5}")
        picture = taken("SVG").decode()
        assert re.findall(r">(22:\d\d)</text>", picture) == ["22:15", "22:20", "22:25", "22:30"]
        png = taken("PNG")
        width, height = int.from_bytes(png[16:20]), int.from_bytes(png[20:24])
        canvas = page.get_by_role("region", name="Sensors in °C").locator("canvas").evaluate("c => [c.width, c.height]")
        assert width == canvas[0]
        assert height > canvas[1]
        # a plot that is zoomed in shows another window as any
        plot = page.get_by_role("region", name="Sensors in °C")
        box = plot.locator(".u-over").bounding_box()
        page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 20)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 20, steps=3)
        page.mouse.up()
        plot.get_by_role("button", name="Whole range").wait_for()
        zoomed = len(taken("CSV").splitlines())
        assert zoomed == pytest.approx(120, abs=15)
        page.get_by_label("Window").select_option("120")
        plot.get_by_role("button", name="Whole range").wait_for(state="detached")
        assert len(taken("CSV").splitlines()) == pytest.approx(61, abs=2)
        # what differs reads so
        card = look.open("overview").locator(".figure", has_text="Reliability")
        card.get_by_text("99.986 %").wait_for()
        assert "nominal99.987 %" in card.text_content()
        assert look.wrong == []


SPACE = """\
schema_version: 1
name: two
components: {left: {rate: 8 FPMH}, right: {rate: 8 FPMH}}
"""


@pytest.mark.full
def test_the_space_bar_chooses_once_and_a_new_part_is_of_unknown_rate(served, visit):
    """A box of the diagram, a row of the tree, a file; once more takes it back."""
    with served(SPACE) as two:
        look = visit(two)
        page = look.open("design")
        for kind, name in ((".react-flow__node", "left"), ("[role=treeitem]", "right")):
            one = page.locator(kind, has_text=name).first
            one.focus()
            page.keyboard.press("Space")
            page.locator("[role=treeitem][aria-selected=true]", has_text=name).wait_for()
        assert page.locator("[role=treeitem][aria-selected=true]").count() == 2
        page.locator(".react-flow__node", has_text="left").first.focus()
        page.keyboard.press("Space")
        page.locator("[role=treeitem][aria-selected=false]", has_text="left").wait_for()
        # what is new has no rate that nobody has said
        page.get_by_role("button", name="Add component").click()
        page.get_by_role("dialog").wait_for()
        page.keyboard.press("Escape")
        assert two.get("/api/design")["document"]["components"]["New component"] == {"rate": "unknown"}
        asked = []
        page.on("filechooser", lambda chooser: asked.append(chooser))
        look.open("new").get_by_role("button", name="Choose files").focus()
        with page.expect_file_chooser():
            page.keyboard.press("Space")
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
        assert len(asked) == 1
        assert look.wrong == []


@pytest.mark.full
def test_every_setting_has_an_effect(served, visit):
    """Of the robot: λ = 18e-6 /h (a lidar and a camera in parallel fail by and by), R = 1, a task of one hour."""
    with served(SMALL) as courier:
        look = visit(courier)
        page = look.open("settings")

        def says(label, value):
            page.get_by_label(label, exact=True).fill(value)
            page.get_by_label(label, exact=True).press("Enter")

        says("Hazard rate at most", "1 FPMH")
        says("Reliability at least", "0.99")
        says("Median remaining life at least", "1000000 h")
        says("Task completion at least", "0.99999")
        says("State also the time until survival falls to", "0.9")
        says("Silent for so long, it is off", "90 s")
        page.get_by_label("Hazard rates in").select_option("FIT")
        page.get_by_label("Colours").select_option("dark")
        assert page.evaluate("document.documentElement.dataset.theme") == "dark"
        found, until = {}, time.monotonic() + 60
        while time.monotonic() < until and (
            len(found.get("why", ())) < 3
            or found["survival"] is None
            or courier.service.prepared().robot.max_gap == 60 * SECOND
        ):
            found = courier.get("/api/health")
        assert [" ".join(one.split()[:3]) for one in found["why"]] == [
            "hazard rate 1.8e-05", "median remaining life", "probability of task",
        ]  # fmt: skip
        assert courier.service.prepared().robot.thresholds.reliability.limit == 0.99
        assert courier.service.prepared().robot.max_gap == 90 * SECOND
        life = found["subjects"][0]["sensor_based"]["remaining_life"]
        assert works(life["survived"]) == pytest.approx(0.9, rel=1e-6)
        page = look.open("overview")
        page.get_by_text("18,000 FIT").first.wait_for()
        card = page.locator(".figure", has_text="Remaining life")
        card.get_by_text("with 90 %").wait_for()
        assert f"with 90 %{life['survived'] / 24:.3g} days" in card.text_content()
        assert look.wrong == []
