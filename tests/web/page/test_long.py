"""What takes longer: the keyboard alone, undo after a reload, two browsers, a service started anew, a silent sensor,
five thousand parts.
"""

import os
import time

import pytest
from playwright.sync_api import expect

from robophm.transports.synthetic import SyntheticOta

from ..conftest import OTA, SMALL, serving

pytestmark = pytest.mark.full


@pytest.fixture
def courier(tmp_path):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    return design


def test_a_group_is_made_renamed_deleted_and_brought_back_by_the_keyboard_alone(courier, visit):
    with serving(courier) as served:
        page = visit(served).open("design")
        press = page.keyboard.press
        page.get_by_role("treeitem", name="courier").focus()
        for key in ("ArrowDown", "ArrowRight", "ArrowDown", "ArrowDown"):
            press(key)
        expect(page.get_by_role("treeitem", name="encoder")).to_have_attribute("aria-selected", "true")
        press("F2")
        expect(page.get_by_label("Name", exact=True)).to_be_focused()
        page.keyboard.type("odometer")
        press("Enter")
        page.get_by_role("treeitem", name="odometer").wait_for()
        page.get_by_role("treeitem", name="odometer").focus()
        press("Shift+ArrowUp")
        press("Control+g")
        page.get_by_label("How they are wired").wait_for()
        press("Enter")
        page.get_by_role("button", name="Group", exact=True).press("Enter")
        page.wait_for_function("() => document.querySelectorAll('dialog').length === 0")
        until = time.monotonic() + 20
        drive = {"parallel": ["motor", "odometer"]}
        while served.get("/api/design")["document"]["modules"]["drive"].get("diagram") != drive:
            assert time.monotonic() < until
            time.sleep(0.05)
        page.get_by_role("treeitem", name="odometer").focus()
        press("Enter")
        press("Delete")
        page.get_by_text("Deleted odometer").wait_for()
        press("Control+z")
        page.get_by_role("treeitem", name="odometer").wait_for()
        press("Control+s")
        page.get_by_text("courier.yaml, saved").wait_for()
        assert "odometer" in courier.read_text()
        press("Control+k")
        page.keyboard.type("lidar")
        press("Enter")
        page.get_by_role("heading", name="lidar").wait_for()


def test_undo_outlives_reload_and_service(courier, visit):
    with serving(courier) as served:
        page = visit(served).open("parts")
        page.get_by_label("Quantity of drive/motor").fill("3")
        page.get_by_label("Quantity of drive/motor").press("Enter")
        page.get_by_text("courier.yaml, not saved").wait_for()
        page.reload()
        page.get_by_role("button", name="Undo").click()
        expect(page.get_by_label("Quantity of drive/motor")).to_have_value("2")
        page.get_by_role("button", name="Redo").click()
        expect(page.get_by_label("Quantity of drive/motor")).to_have_value("3")
    with serving(courier) as served:  # in another browser, to which these edits are somebody else's
        page = visit(served).open("parts")
        expect(page.get_by_label("Quantity of drive/motor")).to_have_value("3")
        page.get_by_role("button", name="Undo").click()
        page.get_by_role("button", name="Undo that").click()
        expect(page.get_by_label("Quantity of drive/motor")).to_have_value("2")
        page.get_by_role("button", name="Redo").click()
        expect(page.get_by_label("Quantity of drive/motor")).to_have_value("3")
    assert courier.read_text() == SMALL


def test_two_browsers_see_each_other_and_a_stale_write_is_offered_again(courier, visit):
    with serving(courier) as served:
        one, other = visit(served), visit(served)
        here, there = one.open("parts"), other.open("parts")
        here.get_by_label("Quantity of drive/motor").fill("4")
        here.get_by_label("Quantity of drive/motor").press("Enter")
        expect(there.get_by_label("Quantity of drive/motor")).to_have_value("4")

        def meanwhile(operation):
            """Somebody else's write arrives while that of this browser is on its way."""

            def write(route):
                served.edit(operation)
                route.continue_()

            there.route("**/api/design/edits", write, times=1)

        quantity = ["modules", "drive", "components", "motor", "quantity"]
        meanwhile({"op": "put", "path": ["name"], "value": "elsewhere"})
        there.get_by_label("Quantity of drive/motor").fill("5")
        there.get_by_label("Quantity of drive/motor").press("Enter")
        expect(here.get_by_label("Quantity of drive/motor")).to_have_value("5")  # of another place: both are made
        assert served.get("/api/design")["document"]["name"] == "elsewhere"
        meanwhile({"op": "put", "path": quantity, "value": 8})
        there.get_by_label("Quantity of drive/motor").fill("6")
        there.get_by_label("Quantity of drive/motor").press("Enter")
        there.get_by_text("Somebody else changed the design").wait_for()
        assert served.get("/api/design")["document"]["modules"]["drive"]["components"]["motor"]["quantity"] == 8
        there.get_by_role("button", name="Make mine too").click()
        expect(here.get_by_label("Quantity of drive/motor")).to_have_value("6")
        other.wrong.clear()  # 409 is an error to the browser's console


def test_a_page_goes_on_when_its_service_is_started_anew(courier, visit):
    with serving(courier) as served:
        look = visit(served)
        page = look.open("design")
        port = int(served.address.rsplit(":", 1)[1].rstrip("/"))
    page.get_by_text("The service does not answer.").wait_for()
    with serving(courier, port=port) as again:
        page.get_by_text("The service does not answer.").wait_for(state="detached", timeout=30_000)
        again.edit({"op": "put", "path": ["name"], "value": "express"})
        page.get_by_role("treeitem", name="express").wait_for()
        look.wrong.clear()


def test_a_sensor_that_goes_silent_is_stale_and_no_zero(tmp_path, visit):
    design, table = tmp_path / "robot.yaml", tmp_path / "drive.csv"
    design.write_bytes(OTA.read_bytes())
    silent = "/ota/power/temperature.temperature"
    signals = sorted(robot_signals(design))
    rows = {}
    for sample in SyntheticOta(seed=3, duration=120_000_000_000).samples(signals):
        if sample.signal != silent or sample.time - 1_709_553_600_000_000_000 < 30_000_000_000:
            rows.setdefault(sample.time, {})[sample.signal] = sample.value
    lines = [",".join(["time", *signals])]
    lines += [
        ",".join([f"{at / 1e9:.3f}", *(repr(row[one]) if one in row else "" for one in signals)])
        for at, row in sorted(rows.items())
    ]
    table.write_text("\n".join(lines) + "\n")
    with serving(design, recordings=(table,)) as served:
        served.post("/api/monitoring/start", {"source": "recordings", "speed": 100})
        page = visit(served).open("overview")
        page.get_by_text("Recording over").wait_for()
        page.locator("main .state", has_text="STALE").first.wait_for()
        page.get_by_text(f"stale {silent}").first.wait_for()
        power = next(one for one in served.get("/api/health")["subjects"] if one["path"] == "Power")
        # by the policy of the design nominal applies: 0 °C would be 2^-2.5 of it
        assert power["sensor_based"]["hazard_rate"] == pytest.approx(power["nominal"]["hazard_rate"], rel=1e-9)


def robot_signals(design):
    from robophm.design.file import load

    return load(design).signals


OPENED = """
window.opened = null;
new MutationObserver(() => {
  const [rows, boxes] = [".tree [role=treeitem]", ".react-flow__node-box"].map((one) => document.querySelectorAll(one));
  if (window.opened === null && rows.length > 20 && boxes.length > 20)
    requestAnimationFrame(() => requestAnimationFrame(() => (window.opened ??= performance.now())));
}).observe(document, {childList: true, subtree: true});
"""
"""When tree and diagram have been painted [ms since the address was asked for]."""


@pytest.mark.parametrize(("modules", "parts"), [(50, 100), (1, 5000)])
def test_five_thousand_parts_open_within_a_second(tmp_path, visit, modules, parts):
    design = tmp_path / "large.yaml"
    lines = ["schema_version: 1", "name: large", "modules:"]
    for module in range(modules):
        lines += [f"  module {module}:", "    components:"]
        lines += [f"      part {part}: {{rate: {1 + part % 7} FIT}}" for part in range(parts)]
    design.write_text("\n".join(lines) + "\n")
    with serving(design) as served:
        served.get("/api/design")  # it has been read
        took = []
        for _ in range(3):
            look = visit(served)
            look.page.add_init_script(OPENED)
            page = look.open("design" if modules > 1 else "design/module 0")
            page.wait_for_function("() => window.opened")
            took.append(page.evaluate("window.opened") / 1000)
        print(f"{modules} modules of {parts} parts: tree and diagram after {min(took):.2f} s")
        # a second of a machine that does nothing else; beside others it takes turns with them
        assert min(took) < max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
        last = f"module {modules - 1}"
        item = page.get_by_role("treeitem", name=last)
        item.click()
        item.press("ArrowRight")
        item.press("End")
        far = page.get_by_role("treeitem", name=f"part {parts - 1}")
        expect(far).to_be_focused()
        expect(far).to_have_attribute("aria-posinset", str(parts))
        assert page.locator(".tree [role=treeitem]").count() < 250
        page.keyboard.press("Home")
        expect(page.get_by_role("treeitem", name="large")).to_be_focused()
        page.keyboard.press("Control+k")
        page.keyboard.type(f"{last}/part {parts // 2}")
        page.keyboard.press("Enter")
        expect(page.get_by_role("treeitem", name=f"part {parts // 2}")).to_be_in_viewport()
        page.locator(".react-flow__node-box, .react-flow__node-tiles").first.wait_for()  # of 5,000 parts 400 are drawn
